/// The options --layers and --tev-layers.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "image/layer_selection.h"

namespace covtrace::cli {

/// Adds an option that takes a list of layers; `selection` must outlive the parser.
void add_layers(CLI::App* command, const std::string& name, LayerSelection& selection,
                const std::string& help);

/// Warns of each named layer that the image has not.
void warn_of_absent_layers(const Image& image, const LayerSelection& selection);

}  // namespace covtrace::cli
