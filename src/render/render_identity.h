/// What tells two renders apart: a film goes on, and films are added, only where all of it agrees.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "integrator/render_scene.h"
#include "render/options.h"

namespace covtrace {

/// What must agree for a render to go on, by name: version, scene, sampling options.
using RenderIdentity = std::map<std::string, std::string>;

/// Version and commit of this program: what films keep as their "version".
std::string program_version();

/// The hash of the scene's content, 16 hexadecimal digits.
std::string scene_hash(const RenderScene& scene);

/// What must agree between a film and a render that is to go on with it.
RenderIdentity render_identity(const RenderScene& scene, const RenderOptions& options);

/// The first difference, as "--seed: 1, not 2"; none where all agree.
std::optional<std::string> difference(const RenderIdentity& is, const RenderIdentity& expected);

}  // namespace covtrace
