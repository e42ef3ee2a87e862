// The camera of a file that has none, and the words that tell where it stands.
#include <cmath>

#include "gltf_fixtures.h"
#include "scene/extent.h"
#include "scene/framing.h"
#include "scene/view_text.h"

namespace covtrace::test {
namespace {

/// Largest distances of the shapes' points from the middle of the picture, whose edges are at 1,
/// and how far the middle between those on opposite sides is from it.
struct Reach {
    double x = 0, y = 0, off_x = 0, off_y = 0;
};

Reach reach(const SceneDescription& scene) {
    const Transform to_camera = scene.camera.camera_to_world.start().inverse();
    const double aspect = double(scene.film.width) / double(scene.film.height);
    const double slope = std::tan(double(scene.camera.fov) * M_PI / 360);
    double low_x = kInfinity, low_y = kInfinity, high_x = -kInfinity, high_y = -kInfinity;
    visit_points(scene, [&](Vec3 p) {
        const Vec3 q = to_camera.point(p);
        EXPECT_GT(q.z, 0);
        const double x = double(q.x / q.z) / (slope * std::max(1.0, aspect));
        const double y = double(q.y / q.z) / (slope * std::max(1.0, 1 / aspect));
        low_x = std::min(low_x, x), high_x = std::max(high_x, x);
        low_y = std::min(low_y, y), high_y = std::max(high_y, y);
    });
    if (low_x > high_x) return {};  // nothing is there
    return {std::max(high_x, -low_x), std::max(high_y, -low_y), (low_x + high_x) / 2,
            (low_y + high_y) / 2};
}

TEST(GltfFraming, FillsPicturesOfAllShapes) {
    // Wide, tall, as flat as a line seen from its end, far from the origin, and copied
    const std::vector<json> placed = {
        {{"scale", {9, 1, 1}}},          {{"scale", {1, 30, 2}}},
        {{"scale", {1e-3, 1e-3, 40}}},   {{"translation", {5e3, -2e3, 1e3}}},
        {{"scale", {1e-6, 1e-6, 1e-6}}}, {{"rotation", {0.7071068, 0, 0, 0.7071068}}},
    };
    for (const json& place : placed) {
        GltfFile file = wave_file(12);
        file.root["nodes"][0].update(place);
        SceneDescription scene = read(file);
        for (const auto& [width, height] : {std::pair{1280, 720}, {400, 400}, {300, 900}}) {
            scene.film.width = width, scene.film.height = height;
            ASSERT_TRUE(frame_all(scene)) << place;
            const Reach most = reach(scene);
            EXPECT_NEAR(std::max(most.x, most.y), 0.9, 0.01) << place << ' ' << width;
            EXPECT_NEAR(most.off_x, 0, 0.01) << place << ' ' << width;
            EXPECT_NEAR(most.off_y, 0, 0.01) << place << ' ' << width;
            EXPECT_GT(scene.camera.focal_distance, 0);
        }
    }
}

TEST(GltfFraming, SeesAllCopies) {
    GltfFile file = wave_file(5);
    for (const double x : {-20.0, 30.0}) file.add_node({{"mesh", 0}, {"translation", {x, 0, 0}}});
    const SceneDescription scene = read(file);
    ASSERT_EQ(scene.instances.size(), 3u);
    const Reach most = reach(scene);
    EXPECT_NEAR(std::max(most.x, most.y), 0.9, 0.01);
    expect_near(bounds(scene).lo, {-20, 0, -0.2f}, 0.03f);
    expect_near(bounds(scene).hi, {31, 1, 0.2f}, 0.03f);
}

TEST(GltfFraming, SeesAPointFromBeforeIt) {
    GltfFile file = wave_file(3);
    file.root["nodes"][0]["scale"] = {0, 0, 0};
    const SceneDescription scene = read(file);
    EXPECT_TRUE(is_finite(scene.camera.camera_to_world.start().point({})));
    EXPECT_GT(reach(scene).x, -1);  // in front of the camera
}

TEST(GltfFraming, TellsWhereTheCameraStands) {
    SceneDescription scene = read(square_file());
    complete(scene);
    const std::string told = all_warnings(scene), view = view_text(scene);
    EXPECT_TRUE(contains(told, "from the front takes its place: " + view)) << told;
    EXPECT_TRUE(contains(view, " fov 40")) << view;
    EXPECT_FALSE(contains(view, "up")) << view;
    EXPECT_FALSE(is_framed(scene));  // it is the scene's from now on
}

TEST(GltfFraming, TellsViewsInRoundNumbers) {
    SceneDescription scene = read(square_file());
    const auto told = [&scene](Vec3 eye, Vec3 target, Vec3 up, float focus) {
        scene.camera.camera_to_world =
            AnimatedTransform(Transform::look_at(eye, target, up)->inverse());
        scene.camera.fov = 35;
        scene.camera.focal_distance = focus;
        return view_text(scene);
    };
    EXPECT_EQ(told({0.5f, 0.5f, 4}, {0.5f, 0.5f, 0}, {0, 1, 0}, 4),
              "eye 0.5,0.5,4 target 0.5,0.5,0 fov 35");
    // A focus far behind all shapes gives way to their middle.
    EXPECT_EQ(told({0.5f, 0.5f, 4}, {0.5f, 0.5f, 0}, {0, 1, 0}, 1e6f),
              "eye 0.5,0.5,4 target 0.5,0.5,0 fov 35");
    EXPECT_EQ(told({0.5f, 0.5f, 4}, {0.5f, 0.5f, 0}, {1, 0, 0}, 4),
              "eye 0.5,0.5,4 target 0.5,0.5,0 fov 35 up 1,0,0");
}

}  // namespace
}  // namespace covtrace::test
