/// Options by which something else takes the place of what the scene says.
#pragma once

#include <CLI/CLI.hpp>

#include "render/overrides.h"
#include "scene/read_options.h"

namespace covtrace::cli {

/// Adds --camera, --gltf-scene, --animation and --variant: `reading` gets what is one of the file's,
/// `overrides` the camera in place of them. Both must outlive the parser.
void add_choice_options(CLI::App* command, SceneOverrides& overrides, ReadOptions& reading);

/// Adds these, and the options of resolution, shutter, lens and environment, with the same
/// lifetimes.
void add_override_options(CLI::App* command, SceneOverrides& overrides, ReadOptions& reading);

}  // namespace covtrace::cli
