#include "gltf/materials.h"

#include <algorithm>

#include "gltf/material_builder.h"

namespace covtrace::gltf {

const Surface& MaterialReader::surface(int index, const std::string& place) {
    if (index >= 0) at(document_, document_.model.materials, index, "materials", place);
    const int key = std::max(index, -1);
    const auto it = surfaces_.find(key);
    if (it != surfaces_.end()) return it->second;
    const bool is_default = key < 0;
    const tinygltf::Material otherwise;
    const tinygltf::Material& material =
        is_default ? otherwise : document_.model.materials[static_cast<size_t>(key)];
    const std::string here = is_default ? place : element("materials", static_cast<size_t>(key));
    Surface surface = MaterialBuilder(document_, scene_, log_, textures_, material, here).build();
    return surfaces_.emplace(key, std::move(surface)).first->second;
}

}  // namespace covtrace::gltf
