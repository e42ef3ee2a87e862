// Whole paths whose result is known in closed form.
#include "support.h"

namespace support {
namespace {

using namespace covariance;

/// A textured plane at the distance z, facing the camera on its axis, lit evenly, moving sideways.
struct Plane {
    Sym2 texture;
    double z = 1;
    Vec3 velocity{};
};

const Frame kToCamera{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

Matrix seen_by(const ThinLens<double>& camera, const Plane& plane) {
    const Surface hit{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {}};
    Field f{{}, kToCamera};
    f = add_texture(f, plane.texture);
    f = surface_exit(f, hit);
    f = motion_exit(f, {plane.velocity, {}});
    f = travel(f, plane.z);
    return sensor(f, camera);
}

ThinLens<double> camera_on_axis(double focus, double radius, double pixels, double shutter) {
    return {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}, focus, radius, pixels, pixels, shutter};
}

/// The textured plane blurred by lens and motion, as primal covariances in pixels^2:
/// (4 pi^2 S2D)^-1 = (4 pi^2 T)^-1 + r^2/4 I + v v^T/12, exactly.
RC_GTEST_PROP(Closed, TexturedPlaneWithDefocusAndMotion, ()) {
    const double z = draw(0.5, 4), focus = draw(0.5, 4), radius = draw(0, 0.1);
    const double pixels = draw(50, 900), shutter = draw(0, 0.1);
    const Plane plane{draw(1, 100) * draw_pd2(), z, {draw(-2, 2), draw(-2, 2), draw(-2, 2)}};
    const Sym2 image = preintegrate(seen_by(camera_on_axis(focus, radius, pixels, shutter), plane));

    const double to_pixels = pixels / z;
    const Sym2 texture = (1 / (to_pixels * to_pixels)) * plane.texture;
    const double r = radius * pixels * (1 / focus - 1 / z);
    const double vx = plane.velocity.x * shutter * to_pixels;
    const double vy = plane.velocity.y * shutter * to_pixels;
    const double four_pi2 = 4 * M_PI * M_PI;
    const Sym2 expected = inverse(four_pi2 * texture) + Sym2::diagonal(r * r / 4, r * r / 4) +
                          Sym2{vx * vx / 12, vx * vy / 12, vy * vy / 12};
    RC_ASSERT(distance(inverse(four_pi2 * image), expected) < 1e-8);
}

TEST(Closed, InFocusNothingVariesOverTheLens) {
    const Plane plane{{4, 1, 3}, 2.5, {}};
    const Matrix s = seen_by(camera_on_axis(2.5, 0.05, 800, 0.02), plane);
    EXPECT_LT(largest(s - Matrix::diagonal(0, 0, s(2, 2), s(3, 3), 0)), 1);
    EXPECT_NEAR(s(2, 2), 0, 1e-15);
    EXPECT_NEAR(s(3, 3), 0, 1e-15);
    EXPECT_NEAR(integration_count(s), 1, 1e-12);
    const double per_pixel = 2.5 / 800;
    EXPECT_NEAR(s(0, 0), 4 * per_pixel * per_pixel, 1e-15);
}

TEST(Closed, OutOfFocusTheLensSeesTheTextureScaled) {
    const double z = 4, focus = 2.5, radius = 0.05;
    const Matrix s = seen_by(camera_on_axis(focus, radius, 800, 0), {{4, 0, 0}, z, {}});
    const double factor = radius * (1 - z / focus);
    EXPECT_NEAR(s(2, 2), 4 * factor * factor, 1e-14);
}

TEST(Closed, MovingPlaneUnderUniformLightIsRankOneInTime) {
    Field f{{}, kToCamera};
    f = add_texture(f, {9, 0, 0});
    f = motion_exit(f, {{0.7, 0, 3}, {}});
    EXPECT_DOUBLE_EQ(f.sigma(0, 0), 9);
    EXPECT_DOUBLE_EQ(f.sigma(0, 4), -0.7 * 9);
    EXPECT_NEAR(f.sigma(4, 4), 0.7 * 0.7 * 9, 1e-14);
}

TEST(Closed, SkyOnAFlatDiffuserIsConstant) {
    const Surface hit{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {}};
    const Frame down = frame_along<double>(Vec3{0.6, 0, -0.8});
    const Field sky = distant_source(down, Sym2{5, 1, 7});
    EXPECT_EQ(reflect_diffuse(surface_enter(sky, hit), hit, Vec3{0, 0, 1}).sigma, Matrix{});
}

/// An edge that touches the ray: the diffuse slice saturates at the frequency of the penumbra,
/// 1/(4 pi^2 (sigma z/(D - z))^2) for a light of deviation sigma at D and an edge z above the
/// floor.
TEST(Closed, PenumbraOfAnEdgeAtTheRay) {
    const double sigma = 0.2, d = 3, z = 1.2;
    Field f = area_source(Sym2::diagonal(sigma * sigma, sigma * sigma), kToCamera);
    f = travel(f, d - z);
    f = occlude(f, Vec3{1e-6, 0, 0}, 1e-7);
    f = travel(f, z);
    const Matrix floor = convolve_angular(f.sigma, Sym2{});
    const double width = sigma * z / (d - z);
    EXPECT_NEAR(floor(0, 0) * 4 * M_PI * M_PI * width * width, 1, 1e-3);
    EXPECT_NEAR(floor(1, 1), 0, 1e-9);
}

/// Two steps of half the distance with a mirror at normal incidence between are one whole step.
TEST(Closed, FlatMirrorUnfoldsThePath) {
    const Field start{Matrix::diagonal(3, 2, 1, 0.5, 0.1), frame_along<double>(Vec3{0.6, 0, -0.8})};
    const Surface hit{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {}};
    Field f = travel(start, 1.5);
    f = surface_enter(f, hit);
    f = reflect_specular(f, hit, Vec3{0.6, 0, 0.8});
    f = surface_exit(f, hit);
    f = travel(f, 2.5);
    EXPECT_LT(distance(f.sigma, travel(start, 4).sigma), 1e-12);
}

/// A concave mirror of radius R images at R/2: light from a far point, one focal length behind the
/// mirror, has all its frequencies in the angle, and none that pair with position.
TEST(Closed, ConcaveMirrorFocusesAtHalfItsRadius) {
    const double radius = 2;
    const Surface hit{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1 / radius, 0, -1 / radius}};
    // A texture in the focal plane leaves as light that depends on direction alone.
    Field f{Matrix::diagonal(4, 4, 0, 0, 0), frame_along<double>(Vec3{0, 0, -1})};
    f = travel(f, radius / 2);
    f = surface_exit(reflect_specular(surface_enter(f, hit), hit, Vec3{0, 0, 1}), hit);
    EXPECT_NEAR(f.sigma(0, 0), 0, 1e-12);
    EXPECT_NEAR(f.sigma(0, 2), 0, 1e-12);
    EXPECT_NEAR(f.sigma(2, 2), 4 * (radius / 2) * (radius / 2), 1e-12);
}

/// The physical lens chain is the direct map with 1/f = 1/z_f + 1/d_s and p = -x_sensor/d_s.
RC_GTEST_PROP(Closed, PhysicalLensAgreesWithTheDirectMap, ()) {
    const Matrix s = draw_psd();
    const double focus = draw(1, 5), f = draw(0.1, 0.8), radius = draw(0.01, 0.2);
    const double behind = 1 / (1 / f - 1 / focus), pixels = draw(10, 100);
    const Matrix direct = sensor(Field{s, kToCamera}, camera_on_axis(focus, radius, pixels, 1));
    // The film's coordinates (x_sensor, u_sensor) of a ray from lens point l to the film point -d_s
    // p, in pixels and lens radii.
    Dense film = Dense::identity();
    for (std::size_t k = 0; k < 2; ++k) {
        film(k, k) = -behind / pixels;
        film(k + 2, k) = -1 / pixels;
        film(k, k + 2) = 0;
        film(k + 2, k + 2) = -radius / behind;
    }
    const Matrix chain = transform(travel(lens(s, f), behind), film);
    RC_ASSERT(distance(chain, direct, largest(s) * radius * radius) < 1e-8);
}

}  // namespace
}  // namespace support
