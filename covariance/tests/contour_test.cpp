// Contours, where a curved surface turns away from a ray, against the outlines of spheres,
// cylinders and ellipsoids, which are known.
#include "support.h"

namespace support {
namespace {

using namespace covariance;

/// The surface at q of the ellipsoid sum (q_i / r_i)^2 = 1.
Surface ellipsoid_at(const Vec3& q, const Vec3& r) {
    const Vec3 g{q.x / (r.x * r.x), q.y / (r.y * r.y), q.z / (r.z * r.z)};
    const double size = length(g);
    const Frame f = draw_frame((1 / size) * g);
    // The normal changes by dn = (H - n n^T H) dq / |g| with H = diag(1 / r^2), seen along the
    // tangents.
    const auto form = [&](const Vec3& a, const Vec3& b) {
        return (a.x * b.x / (r.x * r.x) + a.y * b.y / (r.y * r.y) + a.z * b.z / (r.z * r.z)) / size;
    };
    return {f.z, f.x, f.y, {form(f.x, f.x), form(f.x, f.y), form(f.y, f.y)}};
}

/// The smallest distance from the ray through q along o to the ellipsoid's outline.
double outline_distance(const Vec3& q, const Vec3& o, const Vec3& r) {
    const Frame f = frame_along<double>(o);
    double least = 1e30;
    for (int i = 0; i < 20000; ++i) {
        const double a = 2 * pi<double> * i / 20000;
        const Vec3 m = std::cos(a) * f.x + std::sin(a) * f.y;
        const Vec3 scaled{r.x * m.x, r.y * m.y, r.z * m.z};
        least = std::min(least, length(scaled) - dot(m, q));
    }
    return least;
}

/// A direction that makes an angle with the cosine `c` with n.
Vec3 draw_at(const Vec3& n, double c) {
    const Frame about = draw_frame(n);
    return c * about.z + std::sqrt(1 - c * c) * about.x;
}

RC_GTEST_PROP(Contour, OfASphereIsExact, ()) {
    const double radius = draw(0.1, 5), c = draw(0.01, 0.8);
    const Frame basis = draw_frame(draw_direction());
    const double side = draw_int(0, 1) == 1 ? 1 : -1;  // whichever way the normal points
    const double k = side / radius;
    const Vec3 o = draw_at(basis.z, c);
    const auto found = contour<double>(Surface{side * basis.z, basis.x, basis.y, {k, 0, k}}, o);
    RC_ASSERT(found.has_value());
    const double s = std::sqrt(1 - c * c);
    RC_ASSERT(std::abs(found->distance - radius * (1 - s)) < 1e-9 * radius);
    RC_ASSERT(std::abs(dot(found->direction, o)) < 1e-9);
    // The outline is where the radius is at right angles to the ray.
    const Vec3 from_centre = radius * basis.z + found->offset;
    RC_ASSERT(length(from_centre - radius * found->direction) < 1e-9 * radius);
}

RC_GTEST_PROP(Contour, OfACylinderIsExact, ()) {
    // The cylinder is about the x axis, seen at z = radius.
    const double radius = draw(0.1, 5);
    const double turn = draw(-0.6, 0.6), lean = draw(-1.2, 1.2);  // to the outline; along the axis
    const Vec3 o{std::sin(lean), -std::cos(turn) * std::cos(lean), std::sin(turn) * std::cos(lean)};
    const Vec3 m{0, std::sin(turn), std::cos(turn)};
    const auto found =
        contour<double>(Surface{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1 / radius}}, o);
    RC_PRE(turn > 0.01);
    RC_ASSERT(found.has_value());
    RC_ASSERT(std::abs(found->distance - radius * (1 - std::cos(turn))) < 1e-9 * radius);
    RC_ASSERT(length(found->direction - m) < 1e-9);
    // The point is on the outline, and no farther along it than needed to be beside the ray.
    const Vec3 p = found->offset + Vec3{0, 0, radius};
    RC_ASSERT(std::abs(p.y - radius * m.y) + std::abs(p.z - radius * m.z) < 1e-9 * radius);
    const Vec3 beside = found->offset - dot(found->offset, o) * o;
    if (std::abs(cross(o, m).x) > 0.2)
        RC_ASSERT(length(beside - found->distance * found->direction) < 1e-8 * radius);
}

RC_GTEST_PROP(Contour, OfAnEllipsoidIsWithin15PercentNearIt, ()) {
    const Vec3 r{draw(0.6, 1.6), draw(0.6, 1.6), draw(0.6, 1.6)};
    const Vec3 on_unit = draw_direction();
    const Vec3 q{r.x * on_unit.x, r.y * on_unit.y, r.z * on_unit.z};
    const Surface s = ellipsoid_at(q, r);
    const Vec3 o = draw_at(s.n, draw(0.02, 0.15));
    const auto found = contour<double>(s, o);
    RC_ASSERT(found.has_value());
    const double expected = outline_distance(q, o, r);
    RC_ASSERT(std::abs(found->distance / expected - 1) < 0.15);
}

TEST(Contour, IsNoneWhereTheSurfaceDoesNotTurnAway) {
    const Surface plane;
    EXPECT_FALSE(contour<double>(plane, {0.9, 0, std::sqrt(0.19)}));
    const Surface bowl{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, -1}};
    EXPECT_FALSE(contour<double>(bowl, {0.9, 0, std::sqrt(0.19)}));
    const Surface ball{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {1, 0, 1}};
    EXPECT_TRUE(contour<double>(ball, {0.9, 0, std::sqrt(0.19)}));
    EXPECT_FALSE(contour<double>(ball, {0, 0, 1}));  // more than a radian away
    const Surface saddle{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 1}};
    EXPECT_FALSE(contour<double>(saddle, {0.9, 0, std::sqrt(0.19)}));
    EXPECT_TRUE(contour<double>(saddle, {0, 0.9, std::sqrt(0.19)}));
}

RC_GTEST_PROP(Contour, EndsLightAsAnOccluderAtItsPlace, ()) {
    const Frame basis = draw_frame(draw_direction());
    const Surface ball{basis.z, basis.x, basis.y, {2, 0, 2}};
    const Field field{draw_psd(), draw_frame(draw_at(basis.z, draw(0.05, 0.8)))};
    const Motion motion = draw_motion();
    const auto found = contour<double>(ball, field.frame.z);
    RC_ASSERT(found.has_value());
    const Field ended = end_at_contour(field, *found, 1e-3, motion);
    // The velocity is that of a point that moves with the ball, where the outline touches it.
    const Vec3 velocity = motion.velocity + cross(motion.angular_velocity, found->offset);
    const double ahead = dot(found->offset, field.frame.z);
    const Vec3 offset = std::max(found->distance, 1e-3) * found->direction;
    const Field expected = travel(occlude(travel(field, ahead), offset, 1e-3, velocity), -ahead);
    RC_ASSERT(distance(ended.sigma, expected.sigma) < 1e-9);
    RC_ASSERT(is_psd(ended.sigma - field.sigma, largest(ended.sigma)));
}

}  // namespace
}  // namespace support
