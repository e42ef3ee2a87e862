// Laws of whole events: refraction and mapped normals there and back, sheets in any order, and the
// specialised forms of both against generic products.
#include "support.h"

namespace support {
namespace {

using namespace covariance;

MapSlopes<double> draw_map() {
    return {draw(-0.5, 0.5), draw(-0.5, 0.5), {draw(-1, 1), draw(-1, 1), draw(-1, 1), draw(-1, 1)}};
}

RC_GTEST_PROP(Generic, NormalMap, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const Surface s = draw_surface(field.frame.z);
    const auto normals = normal_field(s, draw_map());
    const Mat2 p = surface_projection(field.frame, s), g = surface_curvature(field.frame, normals);
    RC_ASSERT(distance(surface_enter(field, s, normals).sigma,
                       transform(field.sigma, position_matrix(p, g))) < 1e-11);
    const Mat2 inv = inverse(p);
    const Dense leave = position_matrix(inv, -1.0 * (g * inv));
    RC_ASSERT(distance(surface_exit(field, s, normals).sigma, transform(field.sigma, leave)) <
              1e-11);
}

RC_GTEST_PROP(Inverses, NormalMapExitUndoesEnter, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const Surface s = draw_surface(field.frame.z);
    const auto normals = normal_field(s, draw_map());
    const Field inside = surface_enter(field, s, normals);
    RC_ASSERT(distance(surface_exit(inside, s, normals).sigma, field.sigma, largest(inside.sigma)) <
              1e-10);
}

RC_GTEST_PROP(Inverses, RefractionBackIsNothing, ()) {
    // Light goes into the medium and out again by the same border: a slab without thickness.
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const Surface s = draw_surface(field.frame.z);
    const double n1 = 1, n2 = draw(1.1, 2), eta = n1 / n2;
    const double c1 = -dot(field.frame.z, s.n), c2 = std::sqrt(1 - eta * eta * (1 - c1 * c1));
    const Vec3 inside = eta * field.frame.z + (eta * c1 - c2) * s.n;
    const Field there = surface_exit(refract(surface_enter(field, s), s, inside, n1, n2), s);
    const Field back = surface_exit(refract_to(surface_enter(there, s), s, field.frame, n2, n1), s);
    RC_ASSERT(distance(back.sigma, field.sigma, largest(there.sigma)) < 1e-9);
}

RC_GTEST_PROP(Inverses, MirroredTwiceIsNothing, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const Vec3 out = draw_direction();
    RC_PRE(length(out - field.frame.z) > 0.1);
    const Surface s;
    const Field back = reflect_specular(reflect_specular(field, s, out), s, field.frame.z);
    RC_ASSERT(distance(rotate_to(back, field.frame).sigma, field.sigma) < 1e-11);
}

RC_GTEST_PROP(Invariance, TangentBasisOfAMappedSurface, ()) {
    // Other tangents turn the slopes of the map and their changes along.
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const Surface s = draw_surface(field.frame.z);
    const MapSlopes<double> map = draw_map();
    const double alpha = draw(-3, 3), c = std::cos(alpha), w = std::sin(alpha);
    const Mat2 q{c, -w, w, c};  // old tangent coordinates from new
    const Surface turned{s.n, c * s.t1 + w * s.t2, c * s.t2 - w * s.t1, congruence(s.curvature, q)};
    const MapSlopes<double> same{c * map.a + w * map.b, c * map.b - w * map.a,
                                 transpose(q) * map.changes * q};
    const auto through = [&](const Surface& hit, const MapSlopes<double>& m) {
        const auto normals = normal_field(hit, m);
        const Vec3 out = field.frame.z - 2 * dot(field.frame.z, normals.n) * normals.n;
        return surface_exit(reflect_specular(surface_enter(field, hit, normals),
                                             shading_surface(hit, normals), out),
                            hit, normals);
    };
    const Field one = through(s, map), two = through(turned, same);
    RC_ASSERT(distance(rotate_to(two, one.frame).sigma, one.sigma, largest(field.sigma)) < 1e-8);
}

RC_GTEST_PROP(Volume, MappedMirrorsKeepItAtTheMirrorAngle, ()) {
    // At the geometry's own normal both cosines are the same, and shears keep the volume.
    const Field field{draw_pd(), draw_frame(draw_direction())};
    const Surface s = draw_surface(field.frame.z);
    MapSlopes<double> map = draw_map();
    map.a = map.b = 0;
    const auto normals = normal_field(s, map);
    const Vec3 out = field.frame.z - 2 * dot(field.frame.z, s.n) * s.n;
    const Field left =
        surface_exit(reflect_specular(surface_enter(field, s, normals), s, out), s, normals);
    RC_ASSERT(std::abs(determinant(left.sigma) / determinant(field.sigma) - 1) < 1e-5);
}

RC_GTEST_PROP(Composition, SheetsAddInAnyOrder, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const Surface s = draw_surface(field.frame.z);
    const Sym2 a = draw_pd2(), b = draw_pd2();
    const Field both = pass_through(pass_through(field, s, a), s, b);
    RC_ASSERT(distance(both.sigma, pass_through(field, s, a + b).sigma) < 1e-11);
    RC_ASSERT(distance(both.sigma, pass_through(pass_through(field, s, b), s, a).sigma) < 1e-11);
}

}  // namespace
}  // namespace support
