#include "gltf/extensions.h"

#include <algorithm>
#include <array>

namespace covtrace::gltf {
namespace {

struct LeftOut {
    std::string_view extension, loss;
};

/// Losses of a picture without an extension. None of them is required by the file, or it would have
/// been refused.
constexpr std::array kLeftOut{
    LeftOut{"EXT_lights_ies", "its lamps shine alike in all directions"},
    LeftOut{"EXT_lights_image_based", "its light from all around is missing"},
    LeftOut{"KHR_gaussian_splatting", "its splats are missing"},
    LeftOut{"KHR_materials_volume_scatter", "volumes absorb light but do not scatter it"},
    LeftOut{"KHR_texture_basisu", "the image for other readers is shown, where there is one"},
    LeftOut{"MSFT_lod", "the finest level is rendered"},
    LeftOut{"MSFT_texture_dds", "the image for other readers is shown, where there is one"},
};

/// Extensions that describe a file and change no picture.
constexpr std::array<std::string_view, 8> kDescriptions{
    "EXT_feature_metadata", "EXT_mesh_features",      "EXT_mesh_polygon", "EXT_structural_metadata",
    "FB_ngon_encoding",     "KHR_node_selectability", "KHR_xmp_json_ld",  "OMI_physics_body"};

}  // namespace

void warn_of_left_out(const Document& document, const tinygltf::ExtensionMap& extensions,
                      const std::string& place, WarningLog& log) {
    for (const auto& [name, unused] : extensions) {
        if (is_supported(name) || std::ranges::find(kDescriptions, name) != kDescriptions.end())
            continue;
        const auto known = std::ranges::find(kLeftOut, name, &LeftOut::extension);
        log.add(document.place(place), "extension " + name + " is left out: " +
                                           (known == kLeftOut.end() ? "what it adds is missing"
                                                                    : std::string(known->loss)));
    }
}

}  // namespace covtrace::gltf
