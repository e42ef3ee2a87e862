/// Which layers go with an image: the options --layers and --tev-layers.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "image/image.h"

namespace covtrace::cli {

/// Beside the root's R G B A, which every selection has.
struct LayerSelection {
    bool all = false;                ///< but those that docs/reference/layers.md gives where named
    std::vector<std::string> names;  ///< beside them, or where not all: "raw", "Z" …
};

/// "none", or "all" and names with commas. Names are checked before a render, against what any
/// method writes; throws Error(usage) whose message begins with `option`.
LayerSelection parse_layers(const std::string& option, const std::string& text);

/// Adds an option that takes such a list; `selection` must outlive the parser.
void add_layers(CLI::App* command, const std::string& name, LayerSelection& selection,
                const std::string& help);

/// Whether a layer is among the names.
bool names(const LayerSelection& selection, const std::string& layer);

/// Drops every layer that is not selected.
void keep_layers(Image& image, const LayerSelection& selection);
/// A copy with the selected layers alone, and without metadata.
Image copy_layers(const Image& image, const LayerSelection& selection);

}  // namespace covtrace::cli
