#include "gltf/materials.h"

#include <algorithm>

#include "gltf/material_builder.h"

namespace covtrace::gltf {

const Surface& MaterialReader::surface(int index, ColourUse colours, bool is_unlit,
                                       const std::string& place) {
    if (index >= 0) at(document_, document_.model.materials, index, "materials", place);
    const std::tuple key(std::max(index, -1), colours, is_unlit);
    const auto it = surfaces_.find(key);
    if (it != surfaces_.end()) return it->second;
    const bool is_default = index < 0;
    const tinygltf::Material otherwise;
    const tinygltf::Material& material =
        is_default ? otherwise : document_.model.materials[static_cast<size_t>(index)];
    const std::string here = is_default ? place : element("materials", static_cast<size_t>(index));
    Surface surface =
        MaterialBuilder(document_, scene_, log_, textures_, material, colours, is_unlit, here)
            .build();
    return surfaces_.emplace(key, std::move(surface)).first->second;
}

bool MaterialReader::may_outline(int index) const {
    constexpr double kBrightest = 0.05;
    if (index < 0) return false;
    const tinygltf::Material& m = document_.model.materials[static_cast<size_t>(index)];
    const auto& colour = m.pbrMetallicRoughness.baseColorFactor;
    const auto is_dark = [](double c) { return c <= kBrightest; };
    return !m.doubleSided && m.alphaMode == "OPAQUE" && colour.size() == 4 &&
           std::all_of(colour.begin(), colour.begin() + 3, is_dark) &&
           std::all_of(m.emissiveFactor.begin(), m.emissiveFactor.end(), is_dark) &&
           m.pbrMetallicRoughness.baseColorTexture.index < 0 && m.extensions.empty();
}

}  // namespace covtrace::gltf
