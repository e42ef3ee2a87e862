#include "gltf/colours.h"

#include <algorithm>

#include "gltf/accessor.h"

namespace covtrace::gltf {
namespace {

/// Factor that makes up for an accessor of whole numbers that is not said to be normalised, which
/// the specification requires of colours.
float missing_normalisation(const tinygltf::Accessor& accessor) {
    if (accessor.normalized) return 1;
    if (accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) return 1.0f / 255;
    if (accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) return 1.0f / 65535;
    return 1;
}

}  // namespace

std::vector<VertexColour> read_colours(const Document& document, int accessor,
                                       const std::string& place) {
    const tinygltf::Accessor& source =
        at(document, document.model.accessors, accessor, "accessors", place);
    const size_t components = source.type == TINYGLTF_TYPE_VEC4 ? 4 : 3;
    const Numbers n = read_numbers(document, accessor, components, place);
    const float scale = missing_normalisation(source);
    std::vector<VertexColour> colours(n.count());
    for (size_t i = 0; i < colours.size(); ++i) {
        const float* v = n.element(i);
        const auto value = [&](size_t k) { return std::max(0.0f, scale * v[k]); };
        colours[i].value = {value(0), value(1), value(2)};
        if (components == 4) colours[i].alpha = std::min(1.0f, value(3));
    }
    return colours;
}

ColourUse use_of(const std::vector<VertexColour>& colours) {
    ColourUse use;
    for (const VertexColour& c : colours) {
        use.tints = use.tints || !(c.value == Rgb(1));
        use.has_holes = use.has_holes || c.alpha < 1;
    }
    return use;
}

}  // namespace covtrace::gltf
