// Camera and environment in place of a scene's own, and stand-ins for what a scene does not have.
#include "render/overrides.h"

#include <gtest/gtest.h>

#include "pbrt_test_support.h"
#include "scene/up_axis.h"

namespace covtrace::test {
namespace {

SceneDescription seen(Vec3 eye, Vec3 target, Vec3 up) {
    SceneDescription scene;
    scene.camera.camera_to_world =
        AnimatedTransform(Transform::look_at(eye, target, up)->inverse());
    return scene;
}

TEST(UpAxis, IsTheAxisNearestToThePicturesTop) {
    EXPECT_EQ(up_axis(seen({0, -4, 2}, {}, {0, 0, 1})), (Vec3{0, 0, 1}));
    EXPECT_EQ(up_axis(seen({1, 2, 5}, {}, {0.2f, 1, 0})), (Vec3{0, 1, 0}));
    EXPECT_EQ(up_axis(seen({0, 0, 5}, {}, {0, -1, 0})), (Vec3{0, -1, 0}));
    EXPECT_EQ(up_axis(SceneDescription{}), (Vec3{0, 1, 0}));
    SceneDescription told = seen({0, -4, 2}, {}, {0, 0, 1});
    told.up = Vec3{1, 0, 0};
    EXPECT_EQ(up_axis(told), (Vec3{1, 0, 0}));
}

TEST(CameraOverride, KeepsShutterMediumAndMirror) {
    SceneDescription scene = seen({0, -4, 0}, {}, {0, 0, 1});
    CameraDescription& own = scene.camera;
    own.camera_to_world =
        AnimatedTransform(own.camera_to_world.start() * Transform::scale(-1, 1, 1));
    own.kind = CameraDescription::Kind::orthographic;
    own.shutter_open = 2, own.shutter_close = 3;
    own.medium = 1;
    own.film_irradiance = 0.1f;
    own.lens_radius = 2;
    SceneOverrides overrides;
    overrides.camera = CameraOverride{{3, 0, 4}, {3, 0, 0}, 30, Vec3{0, 1, 0}};
    apply(overrides, scene);
    const CameraDescription& camera = scene.camera;
    EXPECT_EQ(camera.kind, CameraDescription::Kind::perspective);
    EXPECT_EQ(camera.fov, 30);
    EXPECT_EQ(camera.focal_distance, 4);
    EXPECT_EQ(camera.lens_radius, 0);
    EXPECT_EQ(camera.film_irradiance, 1);
    EXPECT_EQ(camera.shutter_open, 2);
    EXPECT_EQ(camera.shutter_close, 3);
    EXPECT_EQ(camera.medium, 1);
    const Transform& t = camera.camera_to_world.start();
    EXPECT_TRUE(t.swaps_handedness());
    EXPECT_EQ(t.point({}), (Vec3{3, 0, 4}));
    EXPECT_EQ(t.vector({0, 0, 1}), (Vec3{0, 0, -1}));
    EXPECT_EQ(t.vector({0, 1, 0}), (Vec3{0, 1, 0}));
}

TEST(CameraOverride, AsksTheScenesOwnCameraWhatIsUp) {
    SceneDescription scene = seen({0, -4, 0}, {}, {0, 0, 1});
    SceneOverrides overrides;
    overrides.camera = CameraOverride{{0, -1, 9}, {}, 30, {}};  // looks down steeply
    apply(overrides, scene);
    EXPECT_EQ(up_axis(scene), (Vec3{0, 0, 1}));
    EXPECT_GT(scene.camera.camera_to_world.start().vector({0, 1, 0}).z, 0);
}

TEST(CameraOverride, AStandInFollowsTheShapeOfThePicture) {
    // A shape ten times as wide as high, before the camera that a reader framed it with
    SceneDescription scene;
    TriangleMesh bar;
    bar.positions = {{-5, -0.5f, 0}, {5, -0.5f, 0}, {5, 0.5f, 0}};
    bar.triangles = {{0, 1, 2}};
    scene.shapes.emplace_back().geometry = std::make_shared<const TriangleMesh>(bar);
    scene.film.width = 1280, scene.film.height = 720;
    scene.no_camera = Warning{{}, "no camera"};
    scene.camera.where.file = std::make_shared<const std::string>("bar.glb");
    const auto distance_at = [&scene](int width, int height) {
        SceneDescription changed = scene;
        SceneOverrides overrides;
        overrides.resolution = {width, height};
        apply(overrides, changed);
        return length(changed.camera.camera_to_world.start().point({}));
    };
    EXPECT_GT(distance_at(300, 300), 1.5f * distance_at(1280, 720));
    EXPECT_NEAR(distance_at(300, 300), distance_at(300, 900), 0.02f);
    // A camera that somebody placed stays
    scene.no_camera.reset();
    EXPECT_EQ(distance_at(300, 300), 0);
}

TEST(EnvironmentOverride, ScalesWhatAnIlluminanceAsksFor) {
    SceneDescription scene = read_world(R"(LightSource "infinite" "float illuminance" 3
        LightSource "infinite" "rgb L" [1 2 3])");
    SceneOverrides overrides;
    overrides.environment_scale = 2;
    apply(overrides, scene);
    EXPECT_EQ(std::get<InfiniteLight>(scene.lights.at(0).value).illuminance, 6);
    EXPECT_EQ(std::get<InfiniteLight>(scene.lights.at(1).value).radiance, (Rgb{2, 4, 6}));
}

TEST(Defaults, CountEveryEmitter) {
    const std::string ball = "Shape \"sphere\"\n";
    EXPECT_TRUE(read_world(ball).no_lights);
    EXPECT_FALSE(read_world("").no_lights) << "nothing is there to be lit";
    EXPECT_FALSE(read_world(ball + "LightSource \"point\"").no_lights);
    EXPECT_FALSE(read_world(ball + "AreaLightSource \"diffuse\"\n" + ball).no_lights);
    EXPECT_FALSE(read_world("MakeNamedMedium \"fire\" \"string type\" \"homogeneous\" \"rgb Le\" "
                            "[1 1 1]\n" +
                            ball)
                     .no_lights);
    const std::string grid =
        "MakeNamedMedium \"fire\" \"string type\" \"uniformgrid\" \"integer nx\" 2 "
        "\"integer ny\" 1 \"integer nz\" 1 \"float density\" [ 1 1 ] ";
    EXPECT_FALSE(read_world(grid + "\"float temperature\" [ 2000 900 ]\n" + ball).no_lights);
    EXPECT_FALSE(read_world(grid + "\"rgb emission\" [ 1 0 0 0 0 0 ]\n" + ball).no_lights);
    EXPECT_TRUE(read_world(grid + "\n" + ball).no_lights);
    EXPECT_TRUE(read_world("AreaLightSource \"diffuse\"\n").no_camera);
    SceneDescription scene = read_world(ball);
    apply({}, scene);
    EXPECT_EQ(scene.lights.size(), 2u);
    apply({}, scene);
    EXPECT_EQ(scene.lights.size(), 2u);
    EXPECT_EQ(scene.warnings.size(), 2u);
}

TEST(Defaults, SkiesAreUprightAndLightAFloorLikeAnEvenOne) {
    SceneDescription scene = read_world("Shape \"sphere\"");
    scene.up = Vec3{0, 0, 1};
    apply({}, scene);
    const LightDescription& light = scene.lights.at(0);
    const HeightGradient sky = std::get<InfiniteLight>(light.value).gradient.value();
    EXPECT_NEAR(sky.level / 3 + 2 * sky.up / 3, 1, 1e-3) << "the integral over the cosine";
    EXPECT_LT(sky.down, 0.5f * sky.level) << "metal shows nothing of an even sky";
    EXPECT_NEAR(length(light.light_to_world.vector({0, 0, 1}) - *scene.up), 0, 1e-6);
}

}  // namespace
}  // namespace covtrace::test
