// Laws of the changes of coordinates: travel, rotation, surfaces, motion, lenses.
#include "support.h"

namespace support {
namespace {

using namespace covariance;

constexpr double kExact = 1e-11;

// ---- specialised forms equal the generic A^T S A

RC_GTEST_PROP(Generic, Travel, ()) {
    const Matrix s = draw_psd();
    const double d = draw(-5, 5);
    RC_ASSERT(distance(travel(s, d), transform(s, travel_matrix(d))) < kExact);
}

RC_GTEST_PROP(Generic, Rotation, ()) {
    const Matrix s = draw_psd();
    const double alpha = draw(-4, 4);
    RC_ASSERT(distance(rotate(s, alpha), transform(s, transverse_matrix(rotation(alpha)))) <
              kExact);
    RC_ASSERT(distance(flip_y(s), transform(s, transverse_matrix(Mat2{1, 0, 0, -1}))) < kExact);
}

RC_GTEST_PROP(Generic, Surface, (bool is_flat)) {
    const Matrix s = draw_psd();
    const Frame f = draw_frame(draw_direction());
    auto hit = draw_surface(f.z);
    if (is_flat) hit.curvature = {};
    RC_ASSERT(distance(surface_enter(s, f, hit), transform(s, surface_enter_matrix(f, hit))) <
              kExact);
    RC_ASSERT(distance(surface_exit(s, f, hit), transform(s, surface_exit_matrix(f, hit))) <
              kExact);
}

RC_GTEST_PROP(Generic, Motion, ()) {
    const Matrix s = draw_psd();
    const Frame f = draw_frame(draw_direction());
    const auto m = draw_motion();
    RC_ASSERT(distance(motion_enter(s, f, m), transform(s, motion_enter_matrix(f, m))) < kExact);
    RC_ASSERT(distance(motion_exit(s, f, m), transform(s, motion_exit_matrix(f, m))) < kExact);
}

RC_GTEST_PROP(Generic, LensAndAngularMap, ()) {
    const Matrix s = draw_psd();
    const double f = draw(0.1, 3);
    RC_ASSERT(distance(lens(s, f), transform(s, lens_matrix(f))) < kExact);
    const double a = draw(-2, 2), b = draw(-2, 2), c = draw(-2, 2), d = draw(-2, 2);
    RC_ASSERT(distance(map_angular(s, {a, b, c, d}),
                       transform(s, angular_map_matrix(Mat2{a, b, c, d}))) < kExact);
}

// ---- composition and inverses

RC_GTEST_PROP(Composition, TravelsAdd, ()) {
    const Matrix s = draw_psd();
    const double a = draw(-5, 5), b = draw(-5, 5);
    RC_ASSERT(distance(travel(travel(s, a), b), travel(s, a + b), largest(travel(s, a))) < kExact);
    RC_ASSERT(distance(travel(travel(s, a), -a), s, largest(travel(s, a))) < kExact);
}

RC_GTEST_PROP(Composition, RotationsAdd, ()) {
    const Matrix s = draw_psd();
    const double a = draw(-4, 4), b = draw(-4, 4);
    RC_ASSERT(distance(rotate(rotate(s, a), b), rotate(s, a + b)) < kExact);
    RC_ASSERT(distance(rotate(rotate(s, a), -a), s) < kExact);
    RC_ASSERT(flip_y(flip_y(s)) == s);
}

RC_GTEST_PROP(Composition, LensesAddTheirPowers, ()) {
    const Matrix s = draw_psd();
    const double f = draw(0.5, 3), g = draw(0.5, 3);
    RC_ASSERT(distance(lens(lens(s, f), g), lens(s, 1 / (1 / f + 1 / g))) < kExact);
    RC_ASSERT(distance(lens(lens(s, f), -f), s, largest(lens(s, f))) < kExact);
}

RC_GTEST_PROP(Composition, EventsMultiplyInTheOrderOfTheLight, ()) {
    const Matrix s = draw_psd();
    const double d = draw(-3, 3), f = draw(0.5, 3);
    RC_ASSERT(distance(lens(travel(s, d), f), transform(s, travel_matrix(d) * lens_matrix(f))) <
              kExact);
}

RC_GTEST_PROP(Inverses, SurfaceExitUndoesEnter, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const auto hit = draw_surface(field.frame.z);
    const Field inside = surface_enter(field, hit);
    RC_ASSERT(distance(surface_exit(inside, hit).sigma, field.sigma, largest(inside.sigma)) <
              1e-10);
}

RC_GTEST_PROP(Inverses, MotionExitUndoesEnter, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const auto m = draw_motion();
    const Field inside = motion_enter(field, m);
    RC_ASSERT(distance(motion_exit(inside, m).sigma, field.sigma, largest(inside.sigma)) < kExact);
    RC_ASSERT(motion_enter(field, Motion{}) == field);
}

RC_GTEST_PROP(Inverses, MotionsAdd, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const auto a = draw_motion(), b = draw_motion();
    const Motion both{a.velocity + b.velocity, a.angular_velocity + b.angular_velocity};
    RC_ASSERT(distance(motion_enter(motion_enter(field, a), b).sigma,
                       motion_enter(field, both).sigma,
                       largest(motion_enter(field, a).sigma)) < kExact);
}

RC_GTEST_PROP(Inverses, RotateToAndBack, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const Frame other = draw_frame_like(field.frame);
    RC_ASSERT(distance(rotate_to(rotate_to(field, other), field.frame).sigma, field.sigma) <
              kExact);
    const double alpha = draw(-4, 4);
    const Field turned = rotate(field, alpha);
    RC_ASSERT(distance(turned.sigma, rotate_to(field, turned.frame).sigma) < kExact);
    RC_ASSERT(distance(flip_y(field).sigma, rotate_to(field, flip_y(field).frame).sigma) < kExact);
}

// ---- results that must not depend on the description

/// Sends light through all events that a path can have between two segments, in the frame that the
/// field has.
Field follow(Field f, const Surface& hit, const Vec3& leaving, const Motion& m, const Sym2& micro) {
    f = travel(f, 0.7);
    f = occlude(f, Vec3{0.3, -0.2, 0.1}, 1e-3, Vec3{1, 2, -1});
    f = travel(f, 0.4);
    f = motion_enter(f, m);
    f = surface_enter(f, hit);
    f = add_cosine_window(f, hit);
    f = reflect_glossy(f, hit, leaving, micro);
    f = add_texture(f, Sym2{3, 1, 2});
    f = surface_exit(f, hit);
    f = motion_exit(f, m);
    return travel(f, 1.3);
}

RC_GTEST_PROP(Invariance, TransverseAxesOfTheRay, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const auto hit = draw_surface(field.frame.z);
    const Vec3 leaving = draw_leaving(hit.n);
    const auto m = draw_motion();
    const Sym2 micro = micro_ggx(0.3, 0.6);
    const Field one = follow(field, hit, leaving, m, micro);
    const Field two =
        follow(rotate_to(field, draw_frame_like(field.frame)), hit, leaving, m, micro);
    RC_ASSERT(distance(rotate_to(two, one.frame).sigma, one.sigma) < 1e-9);
}

RC_GTEST_PROP(Invariance, TransverseAxesInRefraction, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const auto hit = draw_surface(field.frame.z);
    const Vec3 leaving = draw_leaving(-hit.n);
    const auto pass = [&](const Field& f) {
        return surface_exit(
            refract_glossy(surface_enter(f, hit), hit, leaving, 1, 1.5, micro_beckmann(0.4, 0.2)),
            hit);
    };
    const Field one = pass(field);
    const Field two = pass(rotate_to(field, draw_frame_like(field.frame)));
    RC_ASSERT(distance(rotate_to(two, one.frame).sigma, one.sigma) < 1e-8);
}

RC_GTEST_PROP(Invariance, TangentBasisAndSideOfTheNormal, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const auto hit = draw_surface(field.frame.z);
    const Vec3 leaving = draw_leaving(hit.n);
    const auto pass = [&](const Surface& s) {
        return surface_exit(
            reflect_glossy(surface_enter(field, s), s, leaving, micro_ggx(0.3, 0.3)), s);
    };
    const Field one = pass(hit);

    const Frame other = draw_frame_like({hit.t1, hit.t2, hit.n});
    const Mat2 q{dot(hit.t1, other.x), dot(hit.t1, other.y),  //
                 dot(hit.t2, other.x), dot(hit.t2, other.y)};
    const Surface turned{hit.n, other.x, other.y, congruence(hit.curvature, q)};
    RC_ASSERT(distance(pass(turned).sigma, one.sigma) < 1e-9);

    const Surface other_side{-hit.n, hit.t1, hit.t2, -1.0 * hit.curvature};
    RC_ASSERT(distance(pass(other_side).sigma, one.sigma) < 1e-9);
}

// ---- volume and definiteness

RC_GTEST_PROP(Volume, ShearsKeepIt, ()) {
    const Matrix s = draw_pd();
    const double volume = determinant(s);
    const Frame f = draw_frame(draw_direction());
    const auto near = [volume](const Matrix& m) {
        return std::abs(determinant(m) / volume - 1) < 1e-6;
    };
    RC_ASSERT(near(travel(s, draw(-2, 2))));
    RC_ASSERT(near(lens(s, draw(0.5, 2))));
    RC_ASSERT(near(rotate(s, draw(-3, 3))));
    RC_ASSERT(near(flip_y(s)));
    RC_ASSERT(near(motion_enter(s, f, draw_motion())));
    RC_ASSERT(near(curvature_aligned(s, {draw(-1, 1), draw(-1, 1), draw(-1, 1)}, draw(0.2, 1))));
}

RC_GTEST_PROP(Volume, EnteringASurfaceScalesItByTheCosine, ()) {
    const Matrix s = draw_pd();
    const Frame f = draw_frame(draw_direction());
    const auto hit = draw_surface(f.z);
    const double cosine = dot(f.z, hit.n);
    const double ratio = determinant(surface_enter(s, f, hit)) / determinant(s);
    RC_ASSERT(std::abs(ratio / (cosine * cosine) - 1) < 1e-6);
}

RC_GTEST_PROP(Definiteness, EveryChangeOfCoordinatesKeepsIt, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const auto hit = draw_surface(field.frame.z);
    const auto m = draw_motion();
    RC_ASSERT(is_psd(travel(field, draw(-5, 5)).sigma));
    RC_ASSERT(is_psd(rotate(field, draw(-5, 5)).sigma));
    RC_ASSERT(is_psd(flip_y(field).sigma));
    RC_ASSERT(is_psd(surface_enter(field, hit).sigma));
    RC_ASSERT(is_psd(surface_exit(field, hit).sigma));
    RC_ASSERT(is_psd(motion_enter(field, m).sigma));
    RC_ASSERT(is_psd(motion_exit(field, m).sigma));
    RC_ASSERT(is_psd(refract(field, hit, -hit.n, 1, 1.4).sigma));
    RC_ASSERT(is_psd(lens(field, draw(0.1, 3)).sigma));
    RC_ASSERT(is_psd(sensor(
        field, ThinLens<double>{.e3 = -field.frame.z, .focus_distance = 2, .lens_radius = 0.1})));
}

// `sensor` is written out for each camera; its matrix is compared with exact rays in rays_test.
RC_GTEST_PROP(Sensor, IsTheTransformByTheCamerasMatrix, ()) {
    const Matrix s = draw_psd();
    const Frame eye = draw_frame(draw_direction());
    // The ray is up to 53 degrees off the axis, in a frame that is turned and of either handedness.
    const double off = draw(0, 0.8), phi = draw(0, 6.28);
    const Vec3 to_eye =
        std::sqrt(1 - off * off) * eye.z + off * (std::cos(phi) * eye.x + std::sin(phi) * eye.y);
    const Frame f = draw_frame(-to_eye);
    const double focus = draw(0.5, 4), radius = draw_int(0, 1) * draw(0.01, 1), px = draw(10, 100),
                 py = draw(10, 100), shutter = draw(0, 2);
    const auto agrees = [&](const auto& camera) {
        const Matrix expected = transform(s, sensor_matrix(f, camera));
        return distance(sensor(s, f, camera), expected, largest(s)) < kExact;
    };
    RC_ASSERT(agrees(ThinLens<double>{eye.x, eye.y, eye.z, focus, radius, px, py, shutter}));
    RC_ASSERT(
        agrees(OrthographicLens<double>{eye.x, eye.y, eye.z, focus, radius, px, py, shutter}));
}

// ---- aligned closed forms

RC_GTEST_PROP(Aligned, GeneralOperatorsReduceToTheClosedForms, ()) {
    const Matrix s = draw_psd();
    const double c1 = draw(0.3, 1), s1 = std::sqrt(1 - c1 * c1);
    const Sym2 k{draw(-1, 1), draw(-1, 1), draw(-1, 1)};
    const Surface hit{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, k};
    const Frame in{{c1, 0, s1}, {0, 1, 0}, {s1, 0, -c1}};
    RC_ASSERT(distance(surface_enter(s, in, hit),
                       curvature_aligned(project_aligned(s, c1), k, c1)) < kExact);

    const Field arriving{s, in};
    const Field mirrored_field =
        surface_exit(reflect_specular(surface_enter(arriving, hit), hit, Vec3{s1, 0, c1}), hit);
    RC_ASSERT(distance(mirrored_field.sigma, mirror_aligned(s, k, c1)) < 1e-10);

    const double n1 = draw(1, 1.3), n2 = draw(1.3, 2), s2 = n1 / n2 * s1;
    const double c2 = std::sqrt(1 - s2 * s2);
    const Field refracted =
        surface_exit(refract(surface_enter(arriving, hit), hit, Vec3{s2, 0, -c2}, n1, n2), hit);
    RC_ASSERT(distance(refracted.sigma, refract_aligned(s, n1, n2, c1, c2, k)) < 1e-10);
    RC_ASSERT(distance(unproject_aligned(project_aligned(s, c1), c1), s) < kExact);
}

TEST(Surface, GrazingExitIsClampedToTheLeastCosine) {
    const Surface hit{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {}};
    for (const double c : {0.0, 1e-9, 0.01, -0.01}) {
        const double s = std::sqrt(1 - c * c);
        const Frame out{{c, 0, -s}, {0, 1, 0}, {s, 0, c}};
        const Matrix exit = surface_exit(Matrix::diagonal(1, 1, 0, 0, 0), out, hit);
        EXPECT_NEAR(exit(0, 0), 1 / (0.02 * 0.02), 1e-6) << c;
        EXPECT_NEAR(exit(1, 1), 1, 1e-12) << c;
    }
    const Sym2 limited = limit_curvature(Sym2{100, 0, -0.1}, 0.5);
    EXPECT_DOUBLE_EQ(limited.xx, 1);
    EXPECT_NEAR(limited.yy, -0.1, 1e-12);
}

TEST(Frame, AlongAnyDirectionIsOrthonormalAndRightHanded) {
    for (const Vec3& z : {Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{1, 0, 0}, Vec3{0, -1, 0},
                          Vec3{0.6, 0, -0.8}, Vec3{0, 0.8, 0.6}}) {
        const Frame f = frame_along<double>(z);
        EXPECT_NEAR(length(cross(f.x, f.y) - z), 0, 1e-14);
        EXPECT_NEAR(length(cross(z, f.x) - f.y), 0, 1e-14);
    }
}

RC_GTEST_PROP(Frame, TurnsAndMirrorsKeepAnglesAndReachTheDirection, ()) {
    const Frame f = draw_frame(draw_direction());
    const Vec3 to = draw_direction();
    for (const Frame& g :
         {turned_to(f, to), mirrored(f, half_vector(f.z, to, Vec3{1, 0, 0})), turned_to(f, -f.z)}) {
        RC_ASSERT(std::abs(length(g.x) - 1) < 1e-9);
        RC_ASSERT(std::abs(dot(g.x, g.y)) < 1e-9);
        RC_ASSERT(std::abs(dot(g.x, g.z)) < 1e-6);
        RC_ASSERT(std::abs(dot(g.y, g.z)) < 1e-6);
    }
    RC_ASSERT(length(turned_to(f, to).z - to) < 1e-12);
}

// ---- precision

RC_GTEST_PROP(Precision, FloatFollowsDouble, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const auto hit = draw_surface(field.frame.z);
    const Vec3 leaving = draw_leaving(hit.n);
    const auto m = draw_motion();
    const Sym2 micro = micro_ggx(0.3, 0.6);
    const Field reference = follow(field, hit, leaving, m, micro);

    const LightField<float> single{cast<float>(field.sigma),
                                   {field.frame.x, field.frame.y, field.frame.z}};
    const covariance::Surface<float> hit_f{
        hit.n,
        hit.t1,
        hit.t2,
        {static_cast<float>(hit.curvature.xx), static_cast<float>(hit.curvature.xy),
         static_cast<float>(hit.curvature.yy)}};
    const covariance::Motion<float> m_f{m.velocity, m.angular_velocity};
    LightField<float> f = travel(single, 0.7F);
    f = occlude(f, Vec3{0.3, -0.2, 0.1}, 1e-3F, Vec3{1, 2, -1});
    f = travel(f, 0.4F);
    f = motion_enter(f, m_f);
    f = surface_enter(f, hit_f);
    f = add_cosine_window(f, hit_f);
    f = reflect_glossy(f, hit_f, leaving, micro_ggx(0.3F, 0.6F));
    f = add_texture(f, {3, 1, 2});
    f = surface_exit(f, hit_f);
    f = motion_exit(f, m_f);
    f = travel(f, 1.3F);
    // Rounding is relative to the largest matrix on the way, which is the one inside the surface.
    const Field arriving = travel(occlude(travel(field, 0.7), Vec3{0.3, -0.2, 0.1}, 1e-3), 0.4);
    const double peak = largest(surface_enter(motion_enter(arriving, m), hit).sigma);
    RC_ASSERT(distance(cast<double>(f.sigma), reference.sigma, peak) < 1e-4);
}

}  // namespace
}  // namespace support
