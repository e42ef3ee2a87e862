/// A scene as the tools that trace single paths want it.
#pragma once

#include <cstdlib>
#include <memory>

#include "pbrt/read_scene.h"
#include "render/overrides.h"
#include "render/session.h"

namespace covtrace {

/// Reads `file` for an image of width x height pixels, given as the words of a command line.
/// Errors: those of read_pbrt.
inline std::unique_ptr<RenderScene> load_scene(const char* file, const char* width,
                                               const char* height) {
    SceneDescription description = read_pbrt(file);
    SceneOverrides overrides;
    overrides.resolution = {std::atoi(width), std::atoi(height)};
    apply(overrides, description);
    return std::make_unique<RenderScene>(std::move(description));
}

}  // namespace covtrace
