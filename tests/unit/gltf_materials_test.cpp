// Materials, textures, lights and cameras of glTF files.
#include "gltf_fixtures.h"

namespace covtrace::test {
namespace {

/// The square with one material.
SceneDescription with_material(const json& material, const std::string& image = {}) {
    GltfFile file;
    if (!image.empty()) {
        file.root["images"] = {{{"bufferView", file.add_view(image)}, {"mimeType", "image/png"}}};
        file.root["textures"] = {{{"source", 0}}};
    }
    file.root["materials"] = json::array({material});
    file.add_node({{"mesh", file.add_square({{"material", 0}})}});
    return read(file);
}
const std::string kImage = "any bytes: images are decoded by what renders them";

TEST(GltfMaterials, MixesMetalAndDielectric) {
    const auto scene = with_material({{"pbrMetallicRoughness",
                                       {{"baseColorFactor", {0.8, 0.4, 0.2, 1}},
                                        {"metallicFactor", 0.25},
                                        {"roughnessFactor", 0.5}}}});
    const MaterialId id = scene.shapes[0].material;
    const auto& mix = scene.materials[size_t(id)].mix;
    ASSERT_TRUE(mix);
    EXPECT_NEAR(constant_value(scene, mix->amount).r, 0.25f, 1e-6f);
    const auto& base = model_of<CoatedDiffuseMaterial>(scene, mix->materials[0]);
    const auto& metal = model_of<ConductorMaterial>(scene, mix->materials[1]);
    expect_near(constant_value(scene, base.reflectance), {0.8f, 0.4f, 0.2f}, 1e-6f);
    expect_near(constant_value(scene, metal.reflectance), {0.8f, 0.4f, 0.2f}, 1e-6f);
    // The alpha of GGX is the roughness squared.
    EXPECT_NEAR(constant_value(scene, base.u_roughness).r, 0.25f, 1e-6f);
    EXPECT_FALSE(base.remap_roughness);
    EXPECT_TRUE(base.reflects_through_coat);
    EXPECT_EQ(base.eta, 1.5f);
}

TEST(GltfMaterials, DefaultsAreThoseOfTheFormat) {
    const auto metal = with_material(json::object());
    EXPECT_NO_THROW(model_of<ConductorMaterial>(metal, metal.shapes[0].material));
    const auto none = read(square_file());
    EXPECT_EQ(none.shapes[0].alpha, -1);
    EXPECT_NO_THROW(model_of<ConductorMaterial>(none, none.shapes[0].material));
}

TEST(GltfMaterials, ReadsWebpImages) {
    const auto images_of = [](const json& texture, const json& image) {
        GltfFile file;
        const int view = file.add_view(kImage);
        file.root["images"] = {{{"bufferView", view}, {"mimeType", "image/png"}}, image};
        file.root["textures"] = json::array({texture});
        file.root["materials"] = {
            {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
        file.root["extensionsRequired"] = {"EXT_texture_webp"};
        file.add_node({{"mesh", file.add_square({{"material", 0}})}});
        std::vector<ImageTexture> found;
        const auto scene = read(file);
        for (const TextureDescription& t : scene.textures)
            if (const auto* i = std::get_if<ImageTexture>(&t.value)) found.push_back(*i);
        return found;
    };
    const json webp = {{"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}};
    const json embedded = {{"uri", "data:image/webp;base64," + base64("RIFF as WebP")}};
    const auto alone = images_of(webp, embedded);
    ASSERT_FALSE(alone.empty());
    ASSERT_TRUE(alone[0].content);
    EXPECT_EQ(*alone[0].content, "RIFF as WebP");
    // Beside a source for other readers it counts, too.
    json both = webp;
    both["source"] = 0;
    EXPECT_EQ(*images_of(both, embedded).at(0).content, "RIFF as WebP");
    EXPECT_EQ(*images_of({{"source", 0}}, embedded).at(0).content, kImage);
}

TEST(GltfMaterials, WrapsEachAxisInItsOwnWay) {
    GltfFile file;
    file.root["images"] = {{{"bufferView", file.add_view(kImage)}, {"mimeType", "image/png"}}};
    file.root["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}}, {{"wrapT", 33071}}};
    file.root["textures"] = {{{"source", 0}, {"sampler", 0}}, {{"source", 0}, {"sampler", 1}}};
    file.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
                               {"normalTexture", {{"index", 1}}}}};
    file.add_node({{"mesh", file.add_square({{"material", 0}})}});
    const auto scene = read(file);
    const MaterialDescription& m = scene.materials.at(size_t(scene.shapes[0].material));
    using Wrap = ImageTexture::Wrap;
    EXPECT_EQ(
        constant_as<ImageTexture>(scene, std::get<ConductorMaterial>(m.value).reflectance).wrap,
        (ImageTexture::Wraps{Wrap::clamp, Wrap::mirror}));
    EXPECT_EQ(constant_as<ImageTexture>(scene, m.normal_map).wrap,
              (ImageTexture::Wraps{Wrap::repeat, Wrap::clamp}));
    EXPECT_FALSE(contains(all_warnings(scene), "wrap"));
}

TEST(GltfMaterials, ReadsChannelsOfTextures) {
    const auto scene =
        with_material({{"pbrMetallicRoughness",
                        {{"metallicRoughnessTexture", {{"index", 0}}}, {"roughnessFactor", 0.5}}},
                       {"normalTexture", {{"index", 0}, {"scale", 0.5}}}},
                      kImage);
    const MaterialDescription& mixed = scene.materials[size_t(scene.shapes[0].material)];
    ASSERT_TRUE(mixed.mix);
    const auto& metallic = constant_as<ImageTexture>(scene, mixed.mix->amount);
    EXPECT_EQ(metallic.channel, ImageTexture::Channel::blue);
    EXPECT_EQ(metallic.encoding, ImageTexture::Encoding::linear);
    ASSERT_TRUE(metallic.content);
    EXPECT_EQ(*metallic.content, kImage);
    const auto& base = model_of<CoatedDiffuseMaterial>(scene, mixed.mix->materials[0]);
    const auto& squared = constant_as<ScaleTexture>(scene, base.u_roughness);
    EXPECT_EQ(squared.tex, squared.scale);
    const auto& roughness = constant_as<ImageTexture>(scene, squared.tex);
    EXPECT_EQ(roughness.channel, ImageTexture::Channel::green);
    EXPECT_EQ(roughness.scale, 0.5f);
    for (const MaterialId part : mixed.mix->materials) {
        EXPECT_GE(scene.materials[size_t(part)].normal_map, 0);
        EXPECT_EQ(scene.materials[size_t(part)].normal_scale, 0.5f);
        EXPECT_TRUE(scene.materials[size_t(part)].maps_follow_uv);
    }
}

TEST(GltfMaterials, CutsAndBlendsByAlpha) {
    const auto alpha = [](const char* mode, double factor, bool has_image) {
        json pbr = {{"baseColorFactor", {1, 1, 1, factor}}};
        if (has_image) pbr["baseColorTexture"] = {{"index", 0}};
        return with_material({{"alphaMode", mode}, {"pbrMetallicRoughness", pbr}}, kImage);
    };
    const auto masked = alpha("MASK", 0.8, true);
    const auto& mask = constant_as<ImageTexture>(masked, masked.shapes[0].alpha);
    EXPECT_EQ(mask.channel, ImageTexture::Channel::alpha);
    EXPECT_NEAR(*mask.cutoff, 0.5f / 0.8f, 1e-6f);
    EXPECT_TRUE(alpha("MASK", 0.4, false).shapes.empty());
    const auto blended = alpha("BLEND", 0.25, false);
    EXPECT_EQ(constant_value(blended, blended.shapes[0].alpha).r, 0.25f);
    const auto opaque = alpha("OPAQUE", 0.25, true);
    EXPECT_EQ(opaque.shapes[0].alpha, -1);
    EXPECT_TRUE(contains(failure_of([&] { alpha("Mask", 1, false); }).message,
                         "expected OPAQUE, MASK or BLEND"));
}

TEST(GltfMaterials, EmitsWithStrength) {
    const auto scene = with_material(
        {{"emissiveFactor", {1, 0.5, 0}},
         {"doubleSided", true},
         {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 6}}}}}});
    ASSERT_EQ(scene.shapes[0].area_light, 0);
    expect_near(scene.area_lights[0].radiance, {6, 3, 0}, 1e-5f);
    EXPECT_TRUE(scene.area_lights[0].two_sided);
    EXPECT_TRUE(scene.lights.empty());
    // A glow of at most 1 is no lamp.
    const auto glow = with_material({{"emissiveFactor", {1, 0.5, 0}}});
    EXPECT_EQ(glow.lights.size(), 2u);
    EXPECT_TRUE(contains(all_warnings(glow), "no lights"));
}

TEST(GltfMaterials, TakesNumbersOutsideOfTheirRangesToTheNearerEnd) {
    const json sheen = {{"sheenColorFactor", {1, 1, 1}}, {"sheenRoughnessFactor", 2}};
    const auto scene = with_material(
        {{"pbrMetallicRoughness", {{"metallicFactor", -1}, {"baseColorFactor", {0.5, 1, 3, 1}}}},
         {"extensions", {{"KHR_materials_sheen", sheen}, {"KHR_materials_ior", {{"ior", 0.5}}}}}});
    const auto& coat = model_of<CoatedDiffuseMaterial>(scene, scene.shapes[0].material);
    expect_near(constant_value(scene, coat.reflectance), {0.5f, 1, 1}, 0);
    EXPECT_EQ(coat.eta, 1);
    for (const char* told :
         {"materials[0].pbrMetallicRoughness.metallicFactor: expected a number from 0 to 1, found "
          "-1; 0 takes its place",
          "materials[0].pbrMetallicRoughness.baseColorFactor: expected a number from 0 to 1, found "
          "3; 1 takes its place",
          "KHR_materials_sheen.sheenRoughnessFactor: expected a number from 0 to 1, found 2",
          "KHR_materials_ior.ior: expected a number of at least 1, found 0.5; 1 takes its place"})
        EXPECT_TRUE(contains(all_warnings(scene), told)) << told << all_warnings(scene);
    const auto cutout = with_material({{"alphaMode", "MASK"}, {"alphaCutoff", -1}});
    EXPECT_TRUE(contains(all_warnings(cutout), "alphaCutoff: expected a number of at least 0"));
}

TEST(GltfMaterials, TakesRoundingErrorsSilently) {
    const double just_above = 1.00000024;  // as single precision has it
    const auto scene = with_material(
        {{"pbrMetallicRoughness",
          {{"baseColorFactor", {just_above, just_above, just_above, 1}}, {"metallicFactor", 0}}}});
    const auto& coat = model_of<CoatedDiffuseMaterial>(scene, scene.shapes[0].material);
    expect_near(constant_value(scene, coat.reflectance), Rgb(1), 0);
    EXPECT_FALSE(contains(all_warnings(scene), "expected a number"));
}

TEST(GltfMaterials, TakesFactorsOfEmissionAboveOne) {
    const auto scene = with_material({{"emissiveFactor", {8, 4, 0}}});
    expect_near(scene.area_lights[0].radiance, {8, 4, 0}, 0);
    EXPECT_TRUE(scene.lights.empty());
    EXPECT_FALSE(contains(all_warnings(scene), "expected a number"));
}

TEST(GltfMaterials, AbsorbsNothingWhereTheDistanceIsZero) {
    const auto scene = with_material({{"pbrMetallicRoughness", {{"metallicFactor", 0}}},
                                      {"extensions",
                                       {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                                        {"KHR_materials_volume",
                                         {{"thicknessFactor", 1},
                                          {"attenuationDistance", 0},
                                          {"attenuationColor", {0.5, 1, 1}}}}}}});
    EXPECT_TRUE(scene.media.empty());
}

TEST(GltfMaterials, TransmitsDiffuselyAShareOfTheLight) {
    const auto scene = with_material(
        {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"baseColorFactor", {0.8, 0.4, 0.2, 1}}}},
         {"extensions",
          {{"KHR_materials_diffuse_transmission",
            {{"diffuseTransmissionFactor", 0.25},
             {"diffuseTransmissionColorFactor", {1, 0.5, 0.25}}}}}}});
    const auto& mix = scene.materials[size_t(scene.shapes[0].material)].mix;
    ASSERT_TRUE(mix);
    EXPECT_NEAR(constant_value(scene, mix->amount).r, 0.25f, 1e-6f);
    const auto& reflecting = model_of<CoatedDiffuseMaterial>(scene, mix->materials[0]);
    const auto& passing = model_of<DiffuseTransmissionMaterial>(scene, mix->materials[1]);
    expect_near(constant_value(scene, reflecting.reflectance), {0.8f, 0.4f, 0.2f}, 1e-6f);
    expect_near(constant_value(scene, passing.transmittance), {1, 0.5f, 0.25f}, 1e-6f);
    expect_near(constant_value(scene, passing.reflectance), Rgb(0), 0);
    EXPECT_TRUE(scene.shapes[0].is_seen_from_back);
    EXPECT_FALSE(contains(all_warnings(scene), "left out"));
}

TEST(GltfMaterials, TakesAnyRefractiveIndex) {
    const auto eta = [](double ior) {
        const auto scene = with_material({{"pbrMetallicRoughness", {{"metallicFactor", 0}}},
                                          {"extensions", {{"KHR_materials_ior", {{"ior", ior}}}}}});
        return model_of<CoatedDiffuseMaterial>(scene, scene.shapes[0].material).eta;
    };
    EXPECT_NEAR(eta(1.33), 1.33f, 1e-5f);
    EXPECT_NEAR(eta(100), 100, 1e-2f);
    // Borders that reflect everything are met by an index of 1000, which reflects 99.6 %.
    for (const double ior : {0.0, 1000.0, 1e6, 1e300}) EXPECT_NEAR(eta(ior), 1000, 1) << ior;
    EXPECT_EQ(eta(0.5), 1);
}

TEST(GltfMaterials, TurnsTexturesAsTheExtensionSays) {
    // A point of the image that Blender's importer, the sample viewer and three.js agree on:
    // (u, v) = (0.25, 0.5), scale (2, 1), a quarter turn, offset (0.1, 0.2), v downwards:
    // u' = 0.1 + 1 * 0.5 and v' = 0.2 - 2 * 0.25.
    const double quarter = std::acos(-1) / 2;
    const auto scene = with_material(
        {{"pbrMetallicRoughness",
          {{"metallicFactor", 0},
           {"baseColorTexture",
            {{"index", 0},
             {"extensions",
              {{"KHR_texture_transform",
                {{"scale", {2, 1}}, {"rotation", quarter}, {"offset", {0.1, 0.2}}}}}}}}}}},
        kImage);
    const auto& base = model_of<CoatedDiffuseMaterial>(scene, scene.shapes[0].material);
    const TextureMapping& m = constant_as<ImageTexture>(scene, base.reflectance).mapping;
    const float u = 0.25f, v = 1 - 0.5f;  // upwards
    EXPECT_NEAR(m.scale_u * u + m.u_per_v * v + m.delta_u, 0.6f, 1e-6f);
    EXPECT_NEAR(1 - (m.v_per_u * u + m.scale_v * v + m.delta_v), -0.3f, 1e-6f);
}

GltfFile lit_by(const json& light) {
    GltfFile file = square_file();
    file.root["extensions"]["KHR_lights_punctual"]["lights"] = json::array({light});
    const double h = std::sqrt(0.5);
    // The light shines from above: -z becomes -y.
    file.add_node({{"translation", {0, 3, 0}},
                   {"rotation", {-h, 0, 0, h}},
                   {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    return file;
}

TEST(GltfLights, ReadsPunctualLights) {
    const auto point = read(lit_by({{"type", "point"}, {"intensity", 8}, {"color", {1, 0.5, 0}}}));
    const auto& p = std::get<PointLight>(point.lights.at(0).value);
    expect_near(p.intensity, {8, 4, 0}, 0);
    expect_near(p.from, {0, 3, 0}, 1e-6f);
    const auto spot = read(lit_by({{"type", "spot"}, {"spot", {{"outerConeAngle", 0.5}}}}));
    const auto& s = std::get<SpotLight>(spot.lights.at(0).value);
    expect_near(s.to, {0, 2, 0}, 1e-6f);
    EXPECT_NEAR(s.cone_angle, 28.6479f, 1e-3f);
    EXPECT_NEAR(s.cone_delta_angle, 28.6479f, 1e-3f);
    const auto sun = read(lit_by({{"type", "directional"}, {"intensity", 3}}));
    const auto& d = std::get<DistantLight>(sun.lights.at(0).value);
    expect_near(d.radiance, {3, 3, 3}, 0);
    expect_near(d.direction, {0, 1, 0}, 1e-6f);
    EXPECT_TRUE(contains(gltf_error(lit_by({{"type", "disc"}})), "expected point, spot"));
}

TEST(GltfLights, TakesManyLuxForPhysicalUnits) {
    const auto bright = read(lit_by({{"type", "directional"}, {"intensity", 1366}}));
    expect_near(std::get<DistantLight>(bright.lights.at(0).value).radiance, {2, 2, 2}, 1e-5f);
    EXPECT_TRUE(contains(all_warnings(bright), "divided by 683 lm/W"));
}

TEST(GltfCamera, ReadsPerspectiveAndOrthographic) {
    const auto with_camera = [](const json& camera) {
        GltfFile file = square_file();
        file.root["cameras"] = json::array({camera});
        file.add_node({{"camera", 0}, {"translation", {0.5, 0.5, 4}}});
        return read(file);
    };
    const auto wide =
        with_camera({{"type", "perspective"},
                     {"perspective", {{"yfov", 1}, {"znear", 1}, {"aspectRatio", 2}}}});
    EXPECT_NEAR(wide.camera.fov, 57.29578f, 1e-4f);
    EXPECT_EQ(wide.film.width, 1280);
    EXPECT_EQ(wide.film.height, 640);
    const Transform& t = wide.camera.camera_to_world.start();
    expect_near(t.vector({0, 0, 1}), {0, 0, -1}, 0);
    expect_near(t.vector({1, 0, 0}), {1, 0, 0}, 0);
    EXPECT_EQ(wide.camera.focal_distance, 4);
    EXPECT_EQ(wide.camera.lens_radius, 0);
    const auto tall =
        with_camera({{"type", "perspective"},
                     {"perspective", {{"yfov", 1}, {"znear", 1}, {"aspectRatio", 0.5}}}});
    EXPECT_NEAR(tall.camera.fov, 2 * std::atan(0.5 * std::tan(0.5)) * 180 / kPi, 1e-4f);
    EXPECT_EQ(tall.film.height, 1280);
    const auto flat =
        with_camera({{"type", "orthographic"},
                     {"orthographic", {{"xmag", 2}, {"ymag", 1}, {"zfar", 9}, {"znear", 1}}}});
    EXPECT_EQ(*flat.camera.screen_window, (std::array<float, 4>{-2, 2, -1, 1}));
    EXPECT_FALSE(flat.camera.window_fills_film);
}

TEST(GltfCamera, TakesNoScaleFromItsNodes) {
    const auto with_node = [](const json& node, bool is_animated) {
        GltfFile file = square_file();
        file.root["cameras"] = {
            {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}}};
        json camera = node;
        camera["camera"] = 0;
        const int id = file.add_node(camera);
        if (is_animated) {
            const int times = file.add_floats({0, 1}, "SCALAR", 1);
            const int scales = file.add_floats({2, 2, 2, 4, 4, 4}, "VEC3", 3);
            file.root["animations"] = {
                {{"samplers", {{{"input", times}, {"output", scales}}}},
                 {"channels", {{{"sampler", 0}, {"target", {{"node", id}, {"path", "scale"}}}}}}}};
        }
        return (is_animated ? read(file, {{}, std::array<float, 2>{0, 1}}) : read(file)).camera;
    };
    // The camera is turned by 90 degrees about y and looks along -x.
    const json turn = {0, std::sqrt(0.5), 0, std::sqrt(0.5)};
    for (const json& scale : {json{1, 1, 1}, json{2, 2, 2}, json{1, 3, 0.5}, json{-1, 1, 1}}) {
        const auto camera = with_node(
            {{"translation", {4, 0.5, 0.5}}, {"rotation", turn}, {"scale", scale}}, false);
        const Transform& t = camera.camera_to_world.start();
        expect_near(t.vector({0, 0, 1}), {-1, 0, 0}, 1e-6f);
        expect_near(t.vector({0, 1, 0}), {0, 1, 0}, 1e-6f);
        expect_near(t.vector({1, 0, 0}), {0, 0, -1}, 1e-6f);
        expect_near(t.point({}), {4, 0.5f, 0.5f}, 1e-6f);
        EXPECT_NEAR(camera.focal_distance, 3.5f, 1e-5f);
    }
    const auto moving = with_node({{"translation", {0.5, 0.5, 4}}}, true);
    for (const Transform& t : {moving.camera_to_world.start(), moving.camera_to_world.end()})
        EXPECT_NEAR(length(t.vector({0, 0, 1})), 1, 1e-6f);
}

TEST(GltfCamera, FramesTheSceneWithoutOne) {
    const auto scene = read(square_file());
    EXPECT_TRUE(contains(all_warnings(scene), "no camera"));
    const Transform to_camera = scene.camera.camera_to_world.start().inverse();
    const float slope = std::tan(scene.camera.fov * kPi / 360);
    for (const Vec3& p : mesh_of(scene.shapes[0]).positions) {
        const Vec3 c = to_camera.point(p);
        EXPECT_GT(c.z, 0);
        EXPECT_LT(std::abs(c.y), slope * c.z);
    }
    // A square takes a good part of the picture.
    EXPECT_LT(to_camera.point({0.5f, 0.5f, 0}).z, 3);
    // The front faces +z, so that +x is on the right: the picture is no mirror image.
    EXPECT_GT(to_camera.point({1, 0.5f, 0}).x, to_camera.point({0, 0.5f, 0}).x);
}

}  // namespace
}  // namespace covtrace::test
