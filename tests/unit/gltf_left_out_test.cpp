// Warnings of what glTF files hold and covtrace does not render: one for each extension and file.
#include "gltf_fixtures.h"

namespace covtrace::test {
namespace {

/// Lines of the warnings that hold a text.
std::vector<std::string> warnings_with(const SceneDescription& scene, const std::string& text) {
    std::vector<std::string> found;
    for (const Warning& w : scene.warnings)
        if (contains(w.text, text)) found.push_back(w.text);
    return found;
}

TEST(GltfLeftOut, EachExtensionIsToldOnceWithItsLoss) {
    GltfFile file;
    for (int i = 0; i < 3; ++i) {
        json extensions = {{"KHR_materials_volume_scatter", json::object()}};
        if (i == 2) extensions["ACME_paint"] = json::object();
        file.root["materials"].push_back({{"extensions", extensions}});
        file.add_node({{"mesh", file.add_square({{"material", i}})}});
    }
    const auto scene = read(file);
    EXPECT_EQ(
        warnings_with(scene, "KHR_materials_volume_scatter"),
        (std::vector<std::string>{"extension KHR_materials_volume_scatter is left out: volumes "
                                  "absorb light but do not scatter it (and in 2 more places)"}));
    EXPECT_EQ(
        warnings_with(scene, "ACME_paint"),
        (std::vector<std::string>{"extension ACME_paint is left out: what it adds is missing"}));
}

TEST(GltfLeftOut, ExtensionsOutsideOfMaterialsAreTold) {
    GltfFile file;
    const int mesh = file.add_square({{"extensions", {{"ACME_fur", json::object()}}}});
    file.add_node({{"mesh", mesh},
                   {"extensions",
                    {{"EXT_lights_ies", json::object()}, {"KHR_xmp_json_ld", json::object()}}}});
    file.root["scenes"] = {
        {{"nodes", {0}}, {"extensions", {{"EXT_lights_image_based", {{"light", 0}}}}}}};
    const int time = file.add_floats({0}, "SCALAR", 1), value = file.add_floats({1}, "SCALAR", 1);
    const json pointer = {{"ACME_pointer", {{"pointer", "/materials/0/alphaCutoff"}}}};
    file.root["animations"] = {
        {{"samplers", {{{"input", time}, {"output", value}}}},
         {"channels",
          {{{"sampler", 0}, {"target", {{"path", "pointer"}, {"extensions", pointer}}}}}}}};
    const auto scene = read(file);
    for (const char* name :
         {"ACME_fur", "EXT_lights_ies", "EXT_lights_image_based", "ACME_pointer"})
        EXPECT_EQ(warnings_with(scene, std::string("extension ") + name + " is left out: ").size(),
                  1u)
            << name << "\n"
            << all_warnings(scene);
    // Descriptions change no picture.
    EXPECT_TRUE(warnings_with(scene, "KHR_xmp_json_ld").empty());
}

}  // namespace
}  // namespace covtrace::test
