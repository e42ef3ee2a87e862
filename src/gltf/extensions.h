/// Private to this folder: which extensions of glTF are read, and what the others would add.
#pragma once

#include <string>
#include <string_view>

#include "gltf/document.h"

namespace covtrace::gltf {

/// Whether an extension is read; docs/guide/gltf.md says what becomes of each.
constexpr bool is_supported(std::string_view extension) {
    for (const std::string_view name : {"EXT_mesh_gpu_instancing",
                                        "EXT_meshopt_compression",
                                        "EXT_texture_webp",
                                        "KHR_animation_pointer",
                                        "KHR_draco_mesh_compression",
                                        "KHR_lights_punctual",
                                        "KHR_materials_anisotropy",
                                        "KHR_materials_clearcoat",
                                        "KHR_materials_diffuse_transmission",
                                        "KHR_materials_dispersion",
                                        "KHR_materials_emissive_strength",
                                        "KHR_materials_ior",
                                        "KHR_materials_iridescence",
                                        "KHR_materials_pbrSpecularGlossiness",
                                        "KHR_materials_sheen",
                                        "KHR_materials_specular",
                                        "KHR_materials_transmission",
                                        "KHR_materials_unlit",
                                        "KHR_materials_variants",
                                        "KHR_materials_volume",
                                        "KHR_mesh_quantization",
                                        "KHR_meshopt_compression",
                                        "KHR_node_visibility",
                                        "KHR_texture_transform"})
        if (extension == name) return true;
    return false;
}

/// Warns of each extension of an element that is not read, and of what the picture lacks without
/// it. The log makes one warning for each extension of it.
void warn_of_left_out(const Document& document, const tinygltf::ExtensionMap& extensions,
                      const std::string& place, WarningLog& log);

}  // namespace covtrace::gltf
