/// Private to this folder: the colours of vertices (COLOR_0).
#pragma once

#include <string>
#include <vector>

#include "gltf/document.h"
#include "scene/scene_description.h"

namespace covtrace::gltf {

/// Changes that a primitive's COLOR_0 makes; none where all of it is white, or there is none.
struct ColourUse {
    bool tints = false;      ///< whether any colour is not white
    bool has_holes = false;  ///< whether any alpha is below 1
    auto operator<=>(const ColourUse&) const = default;
};

/// The colours in an accessor of three or four numbers each: linear, not below 0, alpha in [0, 1].
std::vector<VertexColour> read_colours(const Document& document, int accessor,
                                       const std::string& place);
ColourUse use_of(const std::vector<VertexColour>& colours);

}  // namespace covtrace::gltf
