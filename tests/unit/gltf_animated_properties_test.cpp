// KHR_animation_pointer: what moves of materials, lights, cameras, weights and visibility.
#include <algorithm>

#include "gltf_fixtures.h"

namespace covtrace::test {
namespace {

constexpr std::array<float, 2> kMiddle{0.9f, 1.1f};  // seconds; its middle is half of the way

/// Adds an animation from 0 to 2 seconds of what a pointer names; `values`: of the keys.
void animate(GltfFile& file, const std::string& pointer, const std::vector<float>& values,
             const std::string& type, size_t components, const std::string& how = "LINEAR") {
    const int times = file.add_floats({0, 2}, "SCALAR", 1);
    const int output = file.add_floats(values, type, components);
    json& animations = file.root["animations"];
    if (animations.empty())
        animations = {{{"channels", json::array()}, {"samplers", json::array()}}};
    json& animation = animations[0];
    animation["samplers"].push_back({{"input", times}, {"output", output}, {"interpolation", how}});
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size() - 1},
         {"target",
          {{"path", "pointer"},
           {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}});
}

GltfFile with_material(const json& material) {
    GltfFile file;
    file.root["materials"] = json::array({material});
    file.add_node({{"mesh", file.add_square({{"material", 0}})}});
    return file;
}

SceneDescription at_time(const GltfFile& file, float open, float close) {
    return read(file, {{}, std::array<float, 2>{open, close}});
}
SceneDescription halfway(const GltfFile& file) {
    return at_time(file, kMiddle[0], kMiddle[1]);
}

TEST(GltfAnimatedProperties, FactorsOfMaterials) {
    GltfFile file = with_material(
        {{"emissiveFactor", {1, 0, 0}},
         {"doubleSided", true},
         {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 2}}}}}});
    animate(file, "/materials/0/emissiveFactor", {1, 0, 0, 0, 0, 1}, "VEC3", 3);
    animate(file, "/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength",
            {4, 8}, "SCALAR", 1);
    const SceneDescription scene = halfway(file);
    ASSERT_EQ(scene.area_lights.size(), 1u);
    expect_near(scene.area_lights[0].radiance, {3, 0, 3}, 1e-5f);
    expect_near(at_time(file, 5, 6).area_lights.at(0).radiance, {0, 0, 8}, 0);
    // Without a shutter the scene is as at 0 seconds.
    expect_near(read(file).area_lights.at(0).radiance, {4, 0, 0}, 0);
    EXPECT_TRUE(contains(all_warnings(read(file)), "it is animated from 0 to 2 seconds"));
    EXPECT_FALSE(contains(all_warnings(scene), "KHR_animation_pointer"));
}

TEST(GltfAnimatedProperties, WhatTheFileLeavesAtItsDefault) {
    // Neither the object nor the list of the factor is in the file.
    GltfFile file = with_material(json::object());
    animate(file, "/materials/0/pbrMetallicRoughness/metallicFactor", {0, 0}, "SCALAR", 1);
    animate(file, "/materials/0/pbrMetallicRoughness/baseColorFactor",
            {0, 0, 0, 1, 0.5f, 0.25f, 0.125f, 1}, "VEC4", 4, "STEP");
    const SceneDescription scene = at_time(file, 2, 3);
    const auto& base = model_of<CoatedDiffuseMaterial>(scene, scene.shapes.at(0).material);
    expect_near(constant_value(scene, base.reflectance), {0.5f, 0.25f, 0.125f}, 1e-6f);
}

TEST(GltfAnimatedProperties, TransformsOfTextures) {
    GltfFile file = with_material(
        {{"pbrMetallicRoughness",
          {{"metallicFactor", 0},
           {"baseColorTexture",
            {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"offset", {0, 0}}}}}}}}}}});
    file.root["images"] = {
        {{"bufferView", file.add_view("bytes of an image")}, {"mimeType", "image/png"}}};
    file.root["textures"] = {{{"source", 0}}};
    animate(file,
            "/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/"
            "offset",
            {0, 0, 0.5f, 0}, "VEC2", 2);
    const SceneDescription scene = halfway(file);
    const auto& base = model_of<CoatedDiffuseMaterial>(scene, scene.shapes.at(0).material);
    EXPECT_NEAR(constant_as<ImageTexture>(scene, base.reflectance).mapping.delta_u, 0.25f, 1e-6f);
}

TEST(GltfAnimatedProperties, LightsAndCameras) {
    GltfFile file = square_file();
    file.root["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "point"}, {"intensity", 1}}};
    file.add_node({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    file.root["cameras"] = {
        {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}}};
    file.add_node({{"camera", 0}, {"translation", {0.5, 0.5, 4}}});
    animate(file, "/extensions/KHR_lights_punctual/lights/0/intensity", {2, 6}, "SCALAR", 1);
    animate(file, "/extensions/KHR_lights_punctual/lights/0/color", {1, 1, 1, 1, 0.5f, 0}, "VEC3",
            3);
    animate(file, "/cameras/0/perspective/yfov", {1, 0.5f}, "SCALAR", 1);
    const SceneDescription scene = halfway(file);
    const auto& light = std::get<PointLight>(scene.lights.at(0).value);
    expect_near(light.intensity, {4, 3, 2}, 1e-5f);
    EXPECT_NEAR(scene.camera.fov, 0.75f * 57.29578f, 1e-3f);
}

TEST(GltfAnimatedProperties, NodesMoveAsByChannelsOfTheirOwn) {
    GltfFile file = square_file();
    animate(file, "/nodes/0/translation", {0, 0, 0, 8, 0, 0}, "VEC3", 3);
    const SceneDescription scene = at_time(file, 0.5f, 1);
    const AnimatedTransform& moved = scene.shapes.at(0).object_to_world;
    expect_near(moved.start().point({0, 0, 0}), {2, 0, 0}, 1e-5f);
    expect_near(moved.end().point({0, 0, 0}), {4, 0, 0}, 1e-5f);
}

TEST(GltfAnimatedProperties, VisibilityAndWeights) {
    GltfFile file = square_file();
    const int up = file.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
    file.root["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", up}}};
    file.root["meshes"][0]["weights"] = {0};
    animate(file, "/meshes/0/weights", {0, 1}, "SCALAR", 1);
    animate(file, "/nodes/0/extensions/KHR_node_visibility/visible", {1, 0}, "SCALAR", 1, "STEP");
    const SceneDescription scene = halfway(file);
    ASSERT_EQ(scene.shapes.size(), 1u);
    EXPECT_NEAR(mesh_of(scene.shapes[0]).positions[0].z, 0.5f, 1e-5f);
    EXPECT_TRUE(at_time(file, 2, 3).shapes.empty());
}

/// The square with two morph targets, by one and by ten upwards.
GltfFile with_targets() {
    GltfFile file = square_file();
    for (const float z : {1.0f, 10.0f})
        file.root["meshes"][0]["primitives"][0]["targets"].push_back(
            {{"POSITION", file.add_floats({0, 0, z, 0, 0, z, 0, 0, z, 0, 0, z}, "VEC3", 3)}});
    return file;
}

TEST(GltfAnimatedProperties, SingleWeights) {
    GltfFile of_mesh = with_targets();  // whose weights have their defaults
    animate(of_mesh, "/meshes/0/weights/1", {0, 1}, "SCALAR", 1);
    EXPECT_NEAR(mesh_of(halfway(of_mesh).shapes.at(0)).positions[0].z, 5, 1e-4f);
    GltfFile of_node = with_targets();
    of_node.root["nodes"][0]["weights"] = {1, 0};
    animate(of_node, "/nodes/0/weights/1", {0, 1}, "SCALAR", 1);
    const SceneDescription scene = halfway(of_node);
    EXPECT_NEAR(mesh_of(scene.shapes.at(0)).positions[0].z, 6, 1e-4f);
    EXPECT_FALSE(contains(all_warnings(scene), "KHR_animation_pointer"));
    for (const char* pointer : {"/meshes/0/weights/2", "/nodes/0/weights/2"}) {
        GltfFile file = of_node;
        animate(file, pointer, {0, 1}, "SCALAR", 1);
        EXPECT_TRUE(contains(all_warnings(halfway(file)), "is nothing of a node, mesh"));
    }
}

TEST(GltfAnimatedProperties, SplinesStayAboveZeroWhereTheirPropertyDoes) {
    // From 1 to 0 with slopes that take the spline below 0 before its end.
    const std::vector<float> overshooting{0, 1, -4, 4, 0, 0};
    GltfFile file = square_file();
    file.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    file.add_node({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    animate(file, "/extensions/KHR_lights_punctual/lights/0/intensity", overshooting, "SCALAR", 1,
            "CUBICSPLINE");
    const auto intensity = [&](float t) {
        const SceneDescription scene = at_time(file, t - 0.01f, t + 0.01f);
        // Others take the place of a light that is out
        const auto* light = std::get_if<PointLight>(&scene.lights.at(0).value);
        return light ? light->intensity.r : 0;
    };
    EXPECT_EQ(intensity(1.5f), 0);
    EXPECT_NEAR(intensity(0.1f), 0.6f, 0.05f);
    // A turn of a texture may be negative.
    GltfFile turned = with_material(
        {{"pbrMetallicRoughness",
          {{"metallicFactor", 0},
           {"baseColorTexture",
            {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"offset", {0, 0}}}}}}}}}}});
    turned.root["images"] = {
        {{"bufferView", turned.add_view("bytes of an image")}, {"mimeType", "image/png"}}};
    turned.root["textures"] = {{{"source", 0}}};
    animate(turned,
            "/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/"
            "offset",
            {0, 0, 1, 0, -4, 0, 4, 0, 0, 0, 0, 0}, "VEC2", 2, "CUBICSPLINE");
    const SceneDescription scene = at_time(turned, 1.49f, 1.51f);
    const auto& base = model_of<CoatedDiffuseMaterial>(scene, scene.shapes.at(0).material);
    EXPECT_LT(constant_as<ImageTexture>(scene, base.reflectance).mapping.delta_u, -0.1f);
}

TEST(GltfAnimatedProperties, FramesAreLitAlikeAtAllMoments) {
    // The lamp is out in the second frame: no sky may take its place there.
    GltfFile file = with_material(
        {{"emissiveFactor", {1, 1, 1}},
         {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 5}}}}}});
    animate(file, "/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength",
            {5, 0}, "SCALAR", 1, "STEP");
    ReadOptions frame{{}, std::array<float, 2>{3, 4}};
    EXPECT_TRUE(contains(all_warnings(read(file, frame)), "the scene has no lights"));
    frame.is_frame = true;
    EXPECT_FALSE(contains(all_warnings(read(file, frame)), "the scene has no lights"));
}

TEST(GltfAnimatedProperties, FramesHaveOneUnitOfLight) {
    // A lamp of 5000 candela that is out at first.
    GltfFile file = square_file();
    file.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    file.add_node({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    animate(file, "/extensions/KHR_lights_punctual/lights/0/intensity", {0, 5000}, "SCALAR", 1);
    for (const float time : {0.1f, 2.0f}) {
        ReadOptions frame{{}, std::array<float, 2>{time, time}};
        (*frame.shutter)[1] += 1e-3f;
        frame.is_frame = true;
        const SceneDescription scene = read(file, frame);
        EXPECT_TRUE(contains(all_warnings(scene), "physical units"));
        const float candela = std::get<PointLight>(scene.lights.at(0).value).intensity.r;
        EXPECT_NEAR(candela, 2500 * time / 683, 0.02f * candela);
    }
}

TEST(GltfAnimatedProperties, PointersToNothingRestAndAreTold) {
    std::string deep = "/materials/0";
    for (int i = 0; i < 100000; ++i) deep += "/a";
    for (const std::string pointer :
         {"/materials/7/alphaCutoff", "/materials/x/alphaCutoff", "/materials/0", "materials/0/a",
          "/textures/0/sampler", "/nodes/9/translation", "/", "", "/cameras/0/perspective/yfov",
          "/materials/0/normalTexture/scale",
          "/materials/0/extensions/KHR_materials_sheen/sheenColorTexture/texCoord", deep.c_str()}) {
        GltfFile file = with_material(json::object());
        animate(file, pointer, {0, 1}, "SCALAR", 1);
        EXPECT_TRUE(contains(all_warnings(halfway(file)),
                             "animations[0].channels[0]: what KHR_animation_pointer moves here "
                             "rests: "))
            << pointer.substr(0, 100);
    }
    // Properties of a node beside its pose are told as for channels without pointers.
    GltfFile file = square_file();
    animate(file, "/nodes/0/skin", {0, 1}, "SCALAR", 1);
    EXPECT_TRUE(contains(all_warnings(halfway(file)), "only translation, rotation, scale"));
}

TEST(GltfAnimatedProperties, SurvivesValuesThatAPropertyCannotHave) {
    // Each is an error of the file or leaves the property as it was; none may do more.
    for (const std::string pointer :
         {"/materials/0/pbrMetallicRoughness", "/materials/0/alphaMode", "/materials/0/name",
          "/materials/0/extensions", "/materials/0/emissiveFactor/0",
          "/materials/0/emissiveFactor/4000000000", "/materials/0/emissiveFactor/x/y",
          "/materials/0/normalTexture/index", "/materials/0/doubleSided"}) {
        GltfFile file = with_material({{"emissiveFactor", {1, 0, 0}}, {"doubleSided", true}});
        animate(file, pointer, {0, 1}, "SCALAR", 1);
        const TemporaryFolder folder;
        const auto path = folder.write("t.gltf", file.text());
        try {
            read_gltf(path, {{}, kMiddle});
        } catch (const Error& e) {
            EXPECT_EQ(e.kind(), ErrorKind::scene) << pointer << ": " << e.what();
        }
    }
}

TEST(GltfAnimatedProperties, ValuesOfAnotherSizeAreTold) {
    for (const char* pointer : {"/materials/0/pbrMetallicRoughness/baseColorFactor",
                                "/materials/0/alphaMode", "/materials/0/emissiveFactor/7"}) {
        GltfFile file =
            with_material({{"pbrMetallicRoughness",
                            {{"baseColorFactor", {0.5, 0.25, 0.125, 1}}, {"metallicFactor", 0}}},
                           {"emissiveFactor", {0, 0, 0}},
                           {"alphaMode", "MASK"}});
        animate(file, pointer, {0.75f, 0.75f}, "SCALAR", 1);
        const SceneDescription scene = halfway(file);
        EXPECT_TRUE(contains(all_warnings(scene), std::string("rests: \"") + pointer +
                                                      "\" cannot have values of 1 number"))
            << all_warnings(scene);
        const auto& base = model_of<CoatedDiffuseMaterial>(scene, scene.shapes.at(0).material);
        expect_near(constant_value(scene, base.reflectance), {0.5f, 0.25f, 0.125f}, 1e-6f);
    }
}

TEST(GltfAnimatedProperties, NamesOfNoPropertyRest) {
    // An exporter of public files animates the offset beside the transform of the texture.
    GltfFile file =
        with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    file.root["images"] = {
        {{"bufferView", file.add_view("bytes of an image")}, {"mimeType", "image/png"}}};
    file.root["textures"] = {{{"source", 0}}};
    animate(file, "/materials/0/pbrMetallicRoughness/baseColorTexture/offset", {0, 1}, "SCALAR", 1);
    const std::string warnings = all_warnings(halfway(file));
    EXPECT_FALSE(contains(warnings, "rests")) << warnings;
}

TEST(GltfAnimatedProperties, ValuesOfAnotherSizeThanTheDefaultAreTold) {
    for (const char* pointer :
         {"/materials/0/emissiveFactor", "/materials/0/pbrMetallicRoughness/roughnessFactor",
          "/materials/0/pbrMetallicRoughness/baseColorFactor",
          "/materials/0/extensions/KHR_materials_clearcoat/clearcoatRoughnessFactor",
          "/materials/0/extensions/KHR_materials_specular/specularColorFactor",
          "/materials/0/extensions/KHR_materials_specular/specularFactor",
          "/materials/0/extensions/KHR_materials_pbrSpecularGlossiness/specularFactor",
          "/materials/0/extensions/KHR_materials_volume/attenuationColor",
          "/materials/0/pbrMetallicRoughness/baseColorTexture/extensions/KHR_texture_transform/"
          "rotation"}) {
        GltfFile file =
            with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
                           {"extensions",
                            {{"KHR_materials_volume", json::object()},
                             {"KHR_materials_transmission", {{"transmissionFactor", 1}}}}}});
        file.root["images"] = {
            {{"bufferView", file.add_view("bytes of an image")}, {"mimeType", "image/png"}}};
        file.root["textures"] = {{{"source", 0}}};
        animate(file, pointer, {1, 1, 1, 1}, "VEC2", 2);
        const std::string warnings = all_warnings(halfway(file));
        EXPECT_TRUE(contains(
            warnings, std::string("rests: \"") + pointer + "\" cannot have values of 2 numbers"))
            << pointer << ": " << warnings;
    }
}

TEST(GltfAnimatedProperties, TheFirstOfTwoCounts) {
    GltfFile file = with_material({{"emissiveFactor", {1, 1, 1}}});
    for (const float strength : {3.0f, 7.0f})
        animate(file, "/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength",
                {strength, strength}, "SCALAR", 1);
    const SceneDescription scene = halfway(file);
    expect_near(scene.area_lights.at(0).radiance, {3, 3, 3}, 0);
    EXPECT_TRUE(contains(all_warnings(scene),
                         "another animation moves the same property; the first one counts"));
}

}  // namespace
}  // namespace covtrace::test
