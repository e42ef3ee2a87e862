/// The layers that go with an image, as people choose them.
#pragma once

#include <string>
#include <vector>

#include "image/image.h"

namespace covtrace {

/// Layers beside the root's R G B A, which every selection has.
struct LayerSelection {
    bool all = false;  ///< all but those that docs/reference/layers.md gives where named
    /// Layers beside these, or the only ones where not all: "raw", "Z" ….
    std::vector<std::string> names;
};

/// Reads "none", or "all" and names with commas. Names are checked before a render, against the
/// layers that any method writes; throws Error(usage) whose message begins with `option`.
LayerSelection parse_layers(const std::string& option, const std::string& text);

/// Whether a layer is among the selection's names.
bool names(const LayerSelection& selection, const std::string& layer);
/// Whether it names a layer of the first surfaces.
bool names_surfaces(const LayerSelection& selection);

/// The named layers that the image has not: not every method makes every layer.
std::vector<std::string> absent_layers(const Image& image, const LayerSelection& selection);
/// Drops every layer that is not selected.
void keep_layers(Image& image, const LayerSelection& selection);
/// A copy of an image with the selected layers alone, and without metadata.
Image copy_layers(const Image& image, const LayerSelection& selection);

}  // namespace covtrace
