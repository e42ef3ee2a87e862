/// The identity of a render: a film goes on, and films are added, only where all of it agrees.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "integrator/render_scene.h"
#include "render/options.h"

namespace covtrace {

/// Properties that must agree for a render to go on, by name: version, scene, sampling options.
using RenderIdentity = std::map<std::string, std::string>;

/// Version and commit of this program: what films keep as their "version".
std::string program_version();

/// The hash of the scene's content, 16 hexadecimal digits.
std::string scene_hash(const RenderScene& scene);

/// The properties of a render, to be compared with those of a film that it is to go on from.
RenderIdentity render_identity(const RenderScene& scene, const RenderOptions& options);

/// The first difference, as "--seed: 1, not 2"; none where all properties agree.
std::optional<std::string> difference(const RenderIdentity& is, const RenderIdentity& expected);

}  // namespace covtrace
