/// The layers that go with an image: the options --layers and --tev-layers.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "image/image.h"

namespace covtrace::cli {

/// Layers beside the root's R G B A, which every selection has.
struct LayerSelection {
    bool all = false;  ///< all but those that docs/reference/layers.md gives where named
    /// Layers beside these, or the only ones where not all: "raw", "Z" ….
    std::vector<std::string> names;
};

/// Reads "none", or "all" and names with commas. Names are checked before a render, against the
/// layers that any method writes; throws Error(usage) whose message begins with `option`.
LayerSelection parse_layers(const std::string& option, const std::string& text);

/// Adds an option that takes a list of layers; `selection` must outlive the parser.
void add_layers(CLI::App* command, const std::string& name, LayerSelection& selection,
                const std::string& help);

/// Whether a layer is among the selection's names.
bool names(const LayerSelection& selection, const std::string& layer);
/// Whether it names a layer of the first surfaces.
bool names_surfaces(const LayerSelection& selection);

/// Warns of each named layer that the image has not: not every method makes every layer.
void warn_of_absent_layers(const Image& image, const LayerSelection& selection);
/// Drops every layer that is not selected.
void keep_layers(Image& image, const LayerSelection& selection);
/// A copy of an image with the selected layers alone, and without metadata.
Image copy_layers(const Image& image, const LayerSelection& selection);

}  // namespace covtrace::cli
