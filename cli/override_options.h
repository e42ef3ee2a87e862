/// Options by which something else takes the place of what the scene says.
#pragma once

#include <CLI/CLI.hpp>

#include "render/overrides.h"

namespace covtrace::cli {

/// Adds the options of resolution, shutter, lens and environment; `overrides` must outlive the
/// parser.
void add_override_options(CLI::App* command, SceneOverrides& overrides);

}  // namespace covtrace::cli
