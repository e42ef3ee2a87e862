/// Which layers go with an image: the options --layers and --tev-layers.
#pragma once

#include <string>
#include <vector>

#include "image/image.h"

namespace covtrace::cli {

/// Beside the root's R G B A, which every selection has.
struct LayerSelection {
    bool all = false;                ///< those of the contract
    std::vector<std::string> names;  ///< beside them, or where not all: "raw", "Z" …
};

/// "none", or "all" and names with commas. Names are checked before a render, against what any
/// method writes; throws Error(usage) whose message begins with `option`.
LayerSelection parse_layers(const std::string& option, const std::string& text);

/// Drops every layer that is not selected.
void keep_layers(Image& image, const LayerSelection& selection);
/// A copy with the selected layers alone, and without metadata.
Image copy_layers(const Image& image, const LayerSelection& selection);

}  // namespace covtrace::cli
