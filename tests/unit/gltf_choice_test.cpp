// Choice of cameras, scenes and animations of glTF files.
#include "gltf_fixtures.h"

namespace covtrace::test {
namespace {

/// The square before cameras whose nodes and cameras have these names; camera i stands at x = i.
GltfFile with_cameras(const std::vector<std::array<const char*, 2>>& names) {
    GltfFile file = square_file();
    for (size_t i = 0; i < names.size(); ++i) {
        file.root["cameras"].push_back({{"name", names[i][1]},
                                        {"type", "perspective"},
                                        {"perspective", {{"yfov", 1}, {"znear", 1}}}});
        file.add_node({{"name", names[i][0]}, {"camera", i}, {"translation", {double(i), 0, 4}}});
    }
    return file;
}

ReadOptions by_camera(const std::string& camera) {
    ReadOptions options;
    options.camera = camera;
    return options;
}

float place_of(const SceneDescription& scene) {
    return scene.camera.camera_to_world.start().point({}).x;
}

std::string refusal(const GltfFile& file, const ReadOptions& options) {
    const Failure f = failure_of([&] { read(file, options); });
    EXPECT_EQ(f.kind, ErrorKind::usage) << f.message;
    return f.message;
}

TEST(GltfChoice, NodesNamesGoBeforeCamerasNames) {
    const GltfFile file = with_cameras({{"a", "b"}, {"b", "c"}, {"", "a"}, {"3", ""}, {"", ""}});
    EXPECT_EQ(place_of(read(file)), 0);
    EXPECT_EQ(place_of(read(file, by_camera("a"))), 0);
    EXPECT_EQ(place_of(read(file, by_camera("b"))), 1);
    EXPECT_EQ(place_of(read(file, by_camera("c"))), 1);
    EXPECT_EQ(place_of(read(file, by_camera("3"))), 3);
    EXPECT_EQ(place_of(read(file, by_camera("4"))), 4);
    EXPECT_EQ(refusal(file, by_camera("5")),
              "camera: there is no camera \"5\"; the file has 0 \"a\", 1 \"b\", 2 \"a\", 3 \"3\", "
              "4");
    for (const char* wrong : {"00x", "-1", "1.0", " 1", "A"})
        EXPECT_TRUE(contains(refusal(file, by_camera(wrong)), "there is no camera")) << wrong;
}

TEST(GltfChoice, TellsWhatIsNotTheDefault) {
    const GltfFile file = with_cameras({{"a", ""}, {"b", ""}});
    EXPECT_EQ(read(file).camera_choice, "");
    EXPECT_EQ(read(file, by_camera("a")).camera_choice, "");
    EXPECT_EQ(read(file, by_camera("b")).camera_choice, "1 \"b\"");
    EXPECT_EQ(read(file, by_camera("1")).camera_choice, "1 \"b\"");
}

TEST(GltfChoice, TwinsAreToldApartByNumber) {
    const GltfFile file = with_cameras({{"a", "x"}, {"a", "x"}});
    EXPECT_EQ(refusal(file, by_camera("a")),
              "camera: \"a\" is the name of several, 0, 1; expected one of these numbers");
    EXPECT_EQ(place_of(read(file, by_camera("1"))), 1);
}

TEST(GltfChoice, ASceneNeedsNoValidDefault) {
    GltfFile file = square_file();
    file.root["scene"] = 7;
    file.root["scenes"] = {{{"name", "one"}, {"nodes", {0}}}};
    EXPECT_TRUE(contains(gltf_error(file), "there is no scenes[7]"));
    ReadOptions options;
    options.gltf_scene = "one";
    EXPECT_EQ(read(file, options).shapes.size(), 1u);
    file.root.erase("scenes");
    EXPECT_TRUE(contains(refusal(file, options),
                         "gltf_scene: there is no scene \"one\"; the file has none"));
}

TEST(GltfChoice, OneAnimationOfSeveralPlays) {
    GltfFile file = square_file();
    const int time = file.add_floats({0}, "SCALAR", 1);
    for (const float x : {1.0f, 2.0f}) {
        const int place = file.add_floats({x, 0, 0}, "VEC3", 3);
        file.root["animations"].push_back(
            {{"name", x == 1 ? "none" : "second"},
             {"samplers", {{{"input", time}, {"output", place}}}},
             {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}});
    }
    const int size = file.add_floats({4, 4, 4}, "VEC3", 3);
    file.root["animations"].push_back(
        {{"samplers", {{{"input", time}, {"output", size}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "scale"}}}}}}});
    const auto scene_of = [&](const std::string& animation) {
        ReadOptions options;
        options.animation = animation;
        return read(file, options);
    };
    const auto place = [&](const std::string& animation) {
        return scene_of(animation).shapes[0].object_to_world.start().point({1, 0, 0}).x - 1;
    };
    EXPECT_EQ(place(""), 1);
    EXPECT_TRUE(contains(all_warnings(scene_of("")),
                         "animations: the first of 3 animations is played, 0 \"none\"; the others "
                         "are 1 \"second\", 2"));
    EXPECT_FALSE(contains(all_warnings(scene_of("all")), "is played"));
    EXPECT_EQ(place("all"), 4);
    EXPECT_EQ(scene_of("").animation_choice, "");
    EXPECT_EQ(scene_of("0").animation_choice, "");
    EXPECT_EQ(scene_of("all").animation_choice, "all");
    EXPECT_EQ(place("0"), 1);
    EXPECT_EQ(place("second"), 2);
    EXPECT_EQ(place("none"), 0);  // whatever animations are called
    // A channel that is not played is not read.
    file.root["animations"][0]["samplers"][0]["input"] = 99;
    EXPECT_EQ(place("second"), 2);
    EXPECT_THROW(place("all"), Error);
}

TEST(GltfChoice, VariantsMapMaterials) {
    GltfFile file;
    for (const float grey : {0.1f, 0.2f, 0.3f})
        file.root["materials"].push_back(
            {{"pbrMetallicRoughness", {{"baseColorFactor", {grey, grey, grey, 1}}}}});
    file.root["extensions"]["KHR_materials_variants"]["variants"] = {
        {{"name", "Day"}}, {{"name", "Night"}}, {{"name", "Dusk"}}};
    const json mappings = {{{"material", 1}, {"variants", {0}}},
                           {{"material", 2}, {"variants", {2, 1}}}};
    const json extensions = {{"KHR_materials_variants", {{"mappings", mappings}}}};
    file.add_node({{"mesh", file.add_square({{"material", 0}, {"extensions", extensions}})}});
    file.add_node({{"mesh", file.add_square({{"material", 0}})}});
    const auto greys = [&](const std::string& variant) {
        ReadOptions options;
        options.variant = variant;
        const auto scene = read(file, options);
        std::vector<float> found;
        for (const ShapeDescription& s : scene.shapes)
            found.push_back(
                constant_value(scene, model_of<ConductorMaterial>(scene, s.material).reflectance)
                    .r);
        return found;
    };
    using Greys = std::vector<float>;
    EXPECT_EQ(greys(""), (Greys{0.1f, 0.1f}));
    EXPECT_EQ(greys("Day"), (Greys{0.2f, 0.1f}));
    EXPECT_EQ(greys("Night"), (Greys{0.3f, 0.1f}));
    EXPECT_EQ(greys("2"), (Greys{0.3f, 0.1f}));
    EXPECT_TRUE(contains(all_warnings(read(file)),
                         "the file has the variants 0 \"Day\", 1 \"Night\", 2 \"Dusk\""));
    ReadOptions options;
    options.variant = "Noon";
    EXPECT_TRUE(contains(refusal(file, options), "variant: there is no variant \"Noon\""));
    options.variant = "Day";
    EXPECT_EQ(read(file, options).variant_choice, "0 \"Day\"");
    EXPECT_FALSE(contains(all_warnings(read(file, options)), "variants"));
    EXPECT_EQ(refusal(square_file(), options),
              "variant: there is no variant \"Day\"; the file has none");
    // Mappings that are none.
    const auto message = [&](const json& broken) {
        GltfFile other = file;
        other.root["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]
                  ["mappings"] = broken;
        return failure_of([&] { read(other, options); }).message;
    };
    EXPECT_TRUE(contains(message(7), "mappings: expected an array"));
    EXPECT_TRUE(contains(message({1}), "mappings[0]: expected an object"));
    EXPECT_TRUE(contains(message({{{"material", 1}}}), "mappings[0].variants: expected an array"));
    EXPECT_TRUE(contains(message({{{"material", 9}, {"variants", {0}}}}), "materials[9]"));
}

}  // namespace
}  // namespace covtrace::test
