// Paths that are walked back by the library, against the same operators called one by one.
#include <covariance/renderer.hpp>

#include "support.h"

namespace support {
namespace {

using namespace covariance;
using Lobe = covariance::Lobe<double>;

struct Scene {
    OccluderGrid<double> grid;
    ThinLens<double> camera{{1, 0, 0}, {0, 1, 0}, {0, 0, -1}, 4, 0.1, 50, 50, 0.02};
    Vec3 eye{0, 0.01, 4};
    Scene() {
        grid.add_sphere({0.3, 0, 0.4}, 0.2);
        grid.build();
    }
};

void expect_equal(const Matrix& a, const Matrix& b) {
    for (std::size_t i = 0; i < 5; ++i)
        for (std::size_t j = 0; j < 5; ++j)
            EXPECT_NEAR(a(i, j), b(i, j), 1e-9 * (1 + std::abs(b(i, j)))) << i << j;
}

const Surface up = surface_with_normal<double>({0, 0, 1});
const Vec3 floor_point{0, 0, 0}, lamp_point{0.5, 0.2, 2};

/// The covariance at the sensor of light that `lamp` sends to the floor.
Matrix by_hand(const Scene& scene, const Lamp<double>& lamp, const Surface& lamp_surface,
               const Emitter<double>& emitter) {
    const Vec3 way = normalize(floor_point - lamp_point), to_eye = normalize(scene.eye);
    LightField field =
        surface_exit(area_source(lamp.moments, frame_along<double>(way)), lamp_surface);
    field = travel_past(scene.grid, field, lamp_point, floor_point);
    field = reflect_diffuse(surface_enter(field, up), up, to_eye, emitter);
    field = surface_exit(add_texture(field, Sym2::diagonal(3, 1)), up);
    field = travel_past(scene.grid, field, floor_point, scene.eye, scene.camera);
    return sensor(field, scene.camera);
}

TEST(Path, WalksAsTheOperatorsOneByOneForALampThatIsSampled) {
    const Scene scene;
    const auto lamp = quad_lamp({1, 0, 0}, {0, 0.5, 0});
    Path<double> path;
    path.begin(scene.eye);
    path.add_vertex(
        {floor_point, up, normalize(scene.eye), Lobe::diffuse(), Sym2::diagonal(3, 1), {}});
    path.add_lamp(lamp, lamp_point, {1, 2, 3});
    const auto [sigma, weight] = covariance_of(path, Part::scattered, scene.grid, scene.camera);
    EXPECT_DOUBLE_EQ(weight, 2);
    const Surface surface{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {}};
    const Emitter<double> emitter{{0, 0, 1}, length(lamp_point - floor_point)};
    EXPECT_NEAR(lamp.moments.xx, 1.0 / 12, 1e-15);
    EXPECT_NEAR(lamp.moments.yy, 0.25 / 12, 1e-15);
    expect_equal(sigma, by_hand(scene, lamp, surface, emitter));
    EXPECT_EQ(covariance_of(path, Part::in_view, scene.grid, scene.camera).second, 0);
}

TEST(Path, BallsFaceWhatTheyLight) {
    const Scene scene;
    Path<double> path;
    path.begin(scene.eye);
    path.add_vertex(
        {floor_point, up, normalize(scene.eye), Lobe::diffuse(), Sym2::diagonal(3, 1), {}});
    path.add_lamp(ball_lamp(0.3), lamp_point, {1, 1, 1});
    const Vec3 way = floor_point - lamp_point;
    expect_equal(covariance_of(path, Part::scattered, scene.grid, scene.camera).first,
                 by_hand(scene, ball_lamp(0.3), surface_with_normal<double>(normalize(way)),
                         {{}, length(way)}));
}

TEST(Path, TheImageOfALampInAFlatMirrorIsItsEmitter) {
    const Scene scene;
    // A lamp at z = 2 that lights the floor by a mirror at x = 1 is where its image is, at x = 2.
    const Vec3 mirror_point{1, 0, 1}, lamp_at{0, 0, 2}, image_at{2, 0, 2};
    const auto lamp = quad_lamp({0.5, 0, 0.5}, {0, 1, 0});
    // Only a curved receiver knows how far away its lamp is.
    const Surface curved = surface_with_normal<double>({0, 0, 1}, 0.5);
    const Surface wall = surface_with_normal<double>({-1, 0, 0});
    Path<double> path;
    path.begin(scene.eye);
    path.add_vertex({floor_point, curved, normalize(scene.eye)});
    path.add_vertex({mirror_point, wall, normalize(floor_point - mirror_point), Lobe::mirror()});
    path.add_lamp(lamp, lamp_at, {1, 1, 1});
    OccluderGrid<double> nothing;
    nothing.build();
    const auto mirrored = covariance_of(path, Part::scattered, nothing, scene.camera).first;
    path.begin(scene.eye);
    path.add_vertex({floor_point, curved, normalize(scene.eye)});
    path.add_lamp(quad_lamp({-0.5, 0, 0.5}, {0, 1, 0}), image_at, {1, 1, 1});
    expect_equal(mirrored, covariance_of(path, Part::scattered, nothing, scene.camera).first);
}

TEST(Path, KeepsTheTwoPartsOfTheLightApart) {
    const Scene scene;
    const Vec3 to_eye = normalize(scene.eye);
    Path<double> path;
    path.begin(scene.eye);
    path.add_lamp(ball_lamp(0.1), {0, 0.005, 2}, {1, 0, 0});  // in front of all
    path.add_vertex({floor_point, up, to_eye, Lobe::fuzzy(0.1)});
    path.add_sky({0, 0, 1}, {0, 1, 0});  // in the metal
    path.add_vertex({{0, 0, 1}, up, {0, 0, -1}});
    path.add_lamp(ball_lamp(0.1), {1, 0, 3}, {0, 0, 1});
    EXPECT_EQ(path.color(Part::in_view), (Vec3{1, 1, 0}));
    EXPECT_EQ(path.color(Part::scattered), (Vec3{0, 0, 1}));
    const auto weight_of = [&](Part part, std::size_t most) {
        return covariance_of(path, part, scene.grid, scene.camera, most).second;
    };
    EXPECT_DOUBLE_EQ(weight_of(Part::in_view, 9), 2.0 / 3);
    EXPECT_DOUBLE_EQ(weight_of(Part::in_view, 0), 1.0 / 3);
    EXPECT_DOUBLE_EQ(weight_of(Part::scattered, 9), 1.0 / 3);
    EXPECT_EQ(weight_of(Part::scattered, 1), 0);
    // A path that is begun anew has forgotten all that.
    path.begin(scene.eye);
    EXPECT_TRUE(path.is_empty());
    EXPECT_EQ(weight_of(Part::in_view, 9), 0);
}

TEST(Path, MergesLightsThatMeetAtAVertexByTheirRadiance) {
    const Scene scene;
    const auto run = [&](double first, double second) {
        Path<double> path;
        path.begin(scene.eye);
        path.add_vertex({floor_point, up, normalize(scene.eye)});
        path.add_lamp(ball_lamp(0.3), lamp_point, {first, first, first});
        path.add_lamp(ball_lamp(0.05), {-1, 0, 1}, {second, second, second});
        OccluderGrid<double> nothing;  // outlines are chosen by the light, which is another then
        nothing.build();
        return covariance_of(path, Part::scattered, nothing, scene.camera);
    };
    const auto [both, weight] = run(1, 3);
    EXPECT_DOUBLE_EQ(weight, 4);
    expect_equal(both, 0.25 * run(1, 0).first + 0.75 * run(0, 1).first);
}

TEST(Lobe, GlassHasItsIndicesOnTheRightSides) {
    const Scene scene;
    // From below through a plane of glass: light comes out of the glass, whose slopes grow by 1.5.
    const covariance::LightField<double> below{Matrix::diagonal(0, 0, 2, 2, 0),
                                               frame_along<double>({0, 0, 1})};
    const Vec3 towards{0, 0, 1};
    const auto out = Lobe::refracting(1, 1.5).scatter(surface_enter(below, up), up, towards, {});
    const auto expected = refract(surface_enter(below, up), up, towards, 1.5, 1);
    expect_equal(out.sigma, expected.sigma);
    EXPECT_NEAR(out.sigma(2, 2), 2 / 2.25, 1e-12);
    const auto rough = Lobe::rough_refracting(1, 1.5, micro_ggx(0.1, 0.1));
    expect_equal(
        rough.scatter(surface_enter(below, up), up, towards, {}).sigma,
        refract_glossy(surface_enter(below, up), up, towards, 1.5, 1, micro_ggx(0.1, 0.1)).sigma);
}

TEST(Lobe, WindowsAreAsSharpAsTheLobes) {
    EXPECT_EQ(Lobe::diffuse().window(), diffuse_receiver<double>);
    EXPECT_EQ(Lobe::mirror().window(), mirror_receiver<double>);
    EXPECT_EQ(Lobe::fuzzy(0).window(), mirror_receiver<double>);
    EXPECT_EQ(Lobe::refracting(1, 1.5).window(), mirror_receiver<double>);
    EXPECT_NEAR(Lobe::fuzzy(0.5).window(), fuzz_cov(0.5).xx, 1e-12);
    // At normal incidence lobes in outgoing slopes are those that the operators convolve with: the
    // variance that light of every frequency keeps.
    const covariance::LightField<double> sharp{Matrix::diagonal(0, 0, 1e12, 1e12, 0),
                                               frame_along<double>({0, 0, -1})};
    const Sym2 micro = micro_ggx(0.2, 0.2);
    for (const Lobe& lobe : {Lobe::glossy(micro), Lobe::around_mirror(phong_cov(50.0))})
        EXPECT_NEAR(lobe.scatter(surface_enter(sharp, up), up, {0, 0, 1}, {}).sigma(2, 2),
                    lobe.window(), 1e-3 * lobe.window());
    const covariance::LightField<double> below{sharp.sigma, frame_along<double>({0, 0, 1})};
    const auto glass = Lobe::rough_refracting(1, 1.5, micro);
    EXPECT_NEAR(glass.scatter(surface_enter(below, up), up, {0, 0, 1}, {}).sigma(2, 2),
                glass.window(), 1e-3 * glass.window());
}

}  // namespace
}  // namespace support
