/// A scene as the tools that trace single paths want it.
#pragma once

#include <cstdlib>
#include <memory>

#include "pbrt/read_scene.h"
#include "render/session.h"

namespace covtrace {

/// Reads `file` for an image of width x height pixels, given as the words of a command line, with
/// the spectra of its lights. Errors: those of read_pbrt.
inline std::unique_ptr<RenderScene> load_scene(const char* file, const char* width,
                                               const char* height) {
    SceneDescription description = read_pbrt(file);
    SceneOverrides overrides;
    overrides.resolution = {std::atoi(width), std::atoi(height)};
    apply(overrides, description);
    auto scene = std::make_unique<RenderScene>(std::move(description));
    scene->prepare_spectra();
    return scene;
}

}  // namespace covtrace
