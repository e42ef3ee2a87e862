// The rules of RULES.md for events beside plain surfaces: mapped normals, sheets and masks, media.
// Against exact rays, closed forms and quadrature.
#include <functional>

#include "support.h"

namespace support {
namespace {

using namespace covariance;

MapSlopes<double> draw_map() {
    return {draw(-0.5, 0.5), draw(-0.5, 0.5), {draw(-1, 1), draw(-1, 1), draw(-1, 1), draw(-1, 1)}};
}

double apart(const Vec3& a, const Vec3& b) {
    return length(a - b);
}

// ---- bump and normal maps

RC_GTEST_PROP(NormalMap, FlatMapIsTheGeometry, ()) {
    const Surface s = draw_surface(draw_direction());
    const Field field{draw_psd(), draw_frame(-s.n)};
    const NormalField<double> flat = normal_field(s, MapSlopes<double>{});
    RC_ASSERT(apart(flat.n, s.n) + apart(flat.d1, normal_field(s).d1) < 1e-14);
    RC_ASSERT(distance(surface_enter(field, s, flat).sigma, surface_enter(field, s).sigma) < 1e-12);
    RC_ASSERT(distance(surface_exit(field, s, flat).sigma, surface_exit(field, s).sigma) < 1e-12);
    // A bump without slope takes its Hessian from the curvature: a hill is convex.
    const Sym2 h = draw_pd2();
    Surface bent = s;
    bent.curvature = s.curvature - h;
    const auto bump = normal_field(s, MapSlopes<double>{0, 0, h});
    RC_ASSERT(apart(bump.d1, normal_field(bent).d1) < 1e-12);
    RC_ASSERT(apart(bump.d2, normal_field(bent).d2) < 1e-12);
}

RC_GTEST_PROP(NormalMap, TurnsAsTheMapCarriedAlongACurvedSurface, ()) {
    // On a sphere of curvature k, tangents are carried along great circles without turning.
    const double k = draw(-1, 1), h = 1e-5;
    const Frame basis = draw_frame(draw_direction());
    const Surface s{basis.z, basis.x, basis.y, {k, 0, k}};
    const MapSlopes<double> map = draw_map();
    const auto normal_at = [&](double s1, double s2) {
        const Vec3 n = normalized_or(s.n + k * (s1 * s.t1 + s2 * s.t2), s.n);
        const Vec3 t1 = rotate_between<double>(s.n, n, s.t1);
        const Vec3 t2 = rotate_between<double>(s.n, n, s.t2);
        const double a = map.a + map.changes.m00 * s1 + map.changes.m01 * s2;
        const double b = map.b + map.changes.m10 * s1 + map.changes.m11 * s2;
        return normalized_or(n - a * t1 - b * t2, n);
    };
    const NormalField<double> field = normal_field(s, map);
    RC_ASSERT(apart(field.n, normal_at(0, 0)) < 1e-14);
    RC_ASSERT(apart(field.d1, (0.5 / h) * (normal_at(h, 0) - normal_at(-h, 0))) < 1e-8);
    RC_ASSERT(apart(field.d2, (0.5 / h) * (normal_at(0, h) - normal_at(0, -h))) < 1e-8);
    RC_ASSERT(std::abs(dot(shading_surface(s, field).t1, field.n)) < 1e-14);
}

RC_GTEST_PROP(NormalMap, MirrorEqualsExactRays, ()) {
    const Surface s;  // the plane z = 0
    const MapSlopes<double> map = draw_map();
    const NormalField<double> normals = normal_field(s, map);
    const Frame in = draw_frame(normalized_or(Vec3{draw(-0.3, 0.3), draw(-0.3, 0.3), -1}, -s.n));
    const Frame out = mirrored(in, normals.n);
    RC_PRE(out.z.z > 0.2);
    const auto normal_at = [&](const Vec3& p) {
        const auto& c = map.changes;
        return normalized_or(s.n - (map.a + c.m00 * p.x + c.m01 * p.y) * s.t1 -
                                 (map.b + c.m10 * p.x + c.m11 * p.y) * s.t2,
                             s.n);
    };
    // Old (arriving) from new (leaving) coordinates of exact rays, by central differences.
    const auto old = [&](std::size_t j, double step) {
        std::array<double, 4> p{};
        p[j] = step;
        const Vec3 d = out.z + p[2] * out.x + p[3] * out.y, o = p[0] * out.x + p[1] * out.y;
        const Vec3 at = o - (o.z / d.z) * d, n = normal_at(at), w = d - 2 * dot(d, n) * n;
        const Vec3 slope = (1 / dot(w, in.z)) * w, back = at - dot(at, in.z) * slope;
        return std::array{dot(back, in.x), dot(back, in.y), dot(slope, in.x), dot(slope, in.y)};
    };
    Dense exact = Dense::identity();
    for (std::size_t j = 0; j < 4; ++j) {
        const auto plus = old(j, 1e-5), minus = old(j, -1e-5);
        for (std::size_t i = 0; i < 4; ++i) exact(i, j) = (plus[i] - minus[i]) / 2e-5;
    }
    const Field field{draw_psd(), in};
    const Field left = surface_exit(
        reflect_specular(surface_enter(field, s, normals), shading_surface(s, normals), out.z), s,
        normals);
    const Matrix expected = transform(field.sigma, exact);
    RC_ASSERT(distance(rotate_to(left, out).sigma, expected, largest(field.sigma)) < 1e-6);
}

RC_GTEST_PROP(NormalMap, FineMapsAddTheirSlopesToTheRoughness, ()) {
    const double ax = draw(0.1, 0.5), ay = draw(0.1, 0.5), vx = draw(0, 0.2), vy = draw(0, 0.2);
    // Beckmann's slopes are Gaussian with the variance alpha^2/2.
    const Sym2 expected = micro_beckmann(std::sqrt(ax * ax + 2 * vx), std::sqrt(ay * ay + 2 * vy));
    RC_ASSERT(distance(roughened(micro_beckmann(ax, ay), Sym2::diagonal(vx, vy)), expected) <
              1e-12);
}

// ---- sheets and masks

RC_GTEST_PROP(Sheet, IsEnterTextureExit, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const Surface s = draw_surface(field.frame.z);
    const Sym2 t = draw_pd2();
    const Field through = pass_through(field, s, t);
    const Field steps = surface_exit(add_texture(surface_enter(field, s), t), s);
    RC_ASSERT(distance(through.sigma, steps.sigma, largest(field.sigma)) < 1e-9);
    RC_ASSERT(through.frame == field.frame);
    RC_ASSERT(is_psd(through.sigma - field.sigma, trace(through.sigma)));
    RC_ASSERT(pass_through(field, s, Sym2{}) == field);
    // The same sheet described by the other side's normal and other tangents.
    const Frame other = draw_frame(-s.n);
    const Sym2 turned = congruence(
        t, Mat2{dot(s.t1, other.x), dot(s.t1, other.y), dot(s.t2, other.x), dot(s.t2, other.y)});
    const Field again = pass_through(field, Surface{other.z, other.x, other.y, {}}, turned);
    RC_ASSERT(distance(again.sigma, through.sigma) < 1e-10);
}

RC_GTEST_PROP(Sheet, VeilsCountByTheirContrast, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const Vec3 offset = draw_vec3(1), velocity = draw_vec3(1);
    const double t = draw(0, 1);
    const Field opaque = occlude(field, offset, 0.1, velocity);
    const Field veil = occlude_partly(field, offset, 0.1, t, velocity);
    const double seen = edge_visibility(t);
    RC_ASSERT(seen >= 0 && seen <= 1);
    RC_ASSERT(distance(veil.sigma - field.sigma, seen * (opaque.sigma - field.sigma),
                       largest(opaque.sigma)) < 1e-12);
    RC_ASSERT(occlude_partly(field, offset, 0.1, 1) == field);
    RC_ASSERT(occlude_partly(field, offset, 0.1, 0, velocity) == opaque);
}

TEST(Sheet, VisibilityIsThatOfAnImageTexture) {
    EXPECT_EQ(edge_visibility(0.0), 1);
    EXPECT_EQ(edge_visibility(1.0), 0);
    EXPECT_DOUBLE_EQ(edge_visibility(0.9), (0.1 / 1.9) / 0.1);
    // Both levels have half of the area: deviation over mean of 1 and t.
    const double mean = 0.95, deviation = 0.05;
    EXPECT_DOUBLE_EQ(edge_visibility(0.9), deviation / mean / 0.1);
    // A mask of mean 0.8 and deviation 0.2 lets 0.2 pass.
    EXPECT_NEAR(contrast_of_complement(0.25, 0.8), 0.2 / 0.2, 1e-15);
}

// ---- media

RC_GTEST_PROP(Absorption, SlabGradientIsThatOfExactLengths, ()) {
    const Frame f = draw_frame(draw_direction());
    const Vec3 n_in = draw_surface(f.z).n, n_out = draw_surface(f.z).n;
    const double d = draw(0.5, 3), extinction = draw(0.1, 2);
    const auto depth = [&](std::size_t j, double step) {
        std::array<double, 4> p{};
        p[j] = step;
        // Offsets are relative to the point of the central ray on the second border.
        const Vec3 o = p[0] * f.x + p[1] * f.y, w = f.z + p[2] * f.x + p[3] * f.y;
        const double first = dot(-d * f.z - o, n_in) / dot(w, n_in);
        const double second = -dot(o, n_out) / dot(w, n_out);
        return extinction * (second - first) * length(w);
    };
    const auto g = slab_gradient(f, n_in, n_out, d, extinction);
    for (std::size_t j = 0; j < 4; ++j)
        RC_ASSERT(std::abs(g[j] - (depth(j, 1e-5) - depth(j, -1e-5)) / 2e-5) < 1e-6);
    RC_ASSERT(g[4] == 0.0);
    // The result has rank one and is positive; planes across the ray do nothing.
    RC_ASSERT(is_psd(absorb(Matrix{}, g)));
    const auto across = slab_gradient(f, f.z, -f.z, d, extinction);
    RC_ASSERT(largest(absorb(Matrix{}, across)) < 1e-25);
}

RC_GTEST_PROP(Volume, DoesNotDependOnTheFrameAndStaysPositive, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const Vec3 out = draw_direction();
    const double g = draw(-0.9, 0.9);
    RC_PRE(std::abs(dot(out, field.frame.z)) < 0.99);
    const Field one = scatter_in_volume(field, out, g);
    const Field two = scatter_in_volume(rotate_to(field, draw_frame_like(field.frame)), out, g);
    RC_ASSERT(length(one.frame.z - out) < 1e-12);
    RC_ASSERT(is_psd(one.sigma, trace(field.sigma)));
    RC_ASSERT(distance(rotate_to(two, one.frame).sigma, one.sigma, largest(field.sigma)) < 1e-8);
}

RC_GTEST_PROP(Volume, IsotropicScatteringForgetsDirections, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const Field out = scatter_in_volume(field, draw_direction(), 0);
    RC_ASSERT(out.sigma.angular() == Sym2{});
    const Field ahead = scatter_in_volume(field, field.frame.z, 0.99999);
    RC_ASSERT(distance(ahead.sigma, field.sigma) < 1e-6);
}

TEST(Volume, SeesNoDetailAlongTheWayTheLightCame) {
    const Field field{Matrix::diagonal(4, 9, 0, 0, 0), Frame{}};
    const Field out = scatter_in_volume(field, Vec3{1, 0, 0}, 0.3);
    // Positions of the leaving ray: along the old z nothing changes, along the old y as before.
    const Field turned = rotate_to(out, Frame{{0, 0, 1}, {0, 1, 0}, {1, 0, 0}});
    EXPECT_NEAR(turned.sigma(0, 0), 0, 1e-12);
    EXPECT_NEAR(turned.sigma(1, 1), 9, 1e-12);
}

/// Curvature -Hess log L/(4 pi^2) of the light that leaves a point of a medium, by quadrature over
/// the arriving slopes and finite differences: nothing of the library but the frames.
Sym2 scattered_angular(double s, double g, double deflection) {
    const Vec3 in{0, 0, 1}, out{std::sin(deflection), 0, std::cos(deflection)};
    const Vec3 out_x{std::cos(deflection), 0, -std::sin(deflection)}, out_y{0, 1, 0};
    const auto leaving = [&](double u, double v) {
        const Vec3 w = normalized_or(out + u * out_x + v * out_y, out);
        double sum = 0;
        constexpr int kSteps = 60;
        for (int i = -kSteps; i <= kSteps; ++i)
            for (int j = -kSteps; j <= kSteps; ++j) {
                const double a = 4 * s * i / kSteps, b = 4 * s * j / kSteps;
                const Vec3 wi = normalized_or(in + Vec3{a, b, 0}, in);
                sum += std::exp(-(a * a + b * b) / (2 * s * s)) * henyey_greenstein(dot(wi, w), g) /
                       std::pow(1 + a * a + b * b, 1.5);
            }
        return std::log(sum);
    };
    const double h = 0.02, f = leaving(0, 0), scale = -1 / (four_pi_sq<double> * h * h);
    return {scale * (leaving(h, 0) - 2 * f + leaving(-h, 0)), 0,
            scale * (leaving(0, h) - 2 * f + leaving(0, -h))};
}

TEST(Volume, ForwardLobeOfHenyeyAndGreensteinIsThatOfQuadrature) {
    // Near the peak the lobe is nearly Gaussian; its long tails cost up to 30 % of the variance
    // (15 % of the bandwidth) when the light is as wide as the lobe.
    for (const double g : {0.5, 0.8}) {
        const double width = (1 - g) / std::sqrt(3 * g);
        for (const double s : {0.1 * width, 0.5 * width, width}) {
            const Sym2 exact = scattered_angular(s, g, 0);
            const double light = 1 / (four_pi_sq<double> * s * s);
            const Field field{Matrix::diagonal(0, 0, light, light, 0), Frame{}};
            const Sym2 ours = scatter_in_volume(field, Vec3{0, 0, 1}, g).sigma.angular();
            EXPECT_NEAR(ours.xx / exact.xx, 1, 0.35) << g << ' ' << s;
            EXPECT_NEAR(ours.yy / exact.yy, 1, 0.35) << g << ' ' << s;
        }
    }
}

TEST(Volume, SideLobeIsNeverSharperThanThePeakAndFallsWithTheAngle) {
    double last = 1e9;
    for (const double angle : {0.0, 0.3, 0.8, 1.5, 2.5}) {
        const Field field{Matrix::diagonal(0, 0, 1e8, 1e8, 0), Frame{}};
        const Field out = scatter_in_volume(field, Vec3{std::sin(angle), 0, std::cos(angle)}, 0.8);
        const double lobe = trace(out.sigma.angular());
        EXPECT_LE(lobe, trace(henyey_greenstein_peak(0.8)) * (1 + 1e-9));
        EXPECT_LT(lobe, last) << angle;
        last = lobe;
    }
}

// ---- both precisions

template <typename T>
SymmetricMatrix5<T> through_everything(const std::array<double, 12>& r) {
    const auto n = [&](std::size_t i) { return static_cast<T>(r[i]); };
    LightField<T> f{SymmetricMatrix5<T>::diagonal(1 + n(0) * n(0), 2, 3, 1 + n(1) * n(1), 1),
                    frame_along<T>(Vec3{0.2, 0.1, -0.97})};
    f.frame = frame_along<T>(normalized_or(f.frame.z, Vec3{0, 0, -1}));
    const covariance::Surface<T> s{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {n(2), n(3), n(4)}};
    const auto map = normal_field(s, MapSlopes<T>{n(5) / 4, n(6) / 4, {n(7), n(8), n(8), n(9)}});
    f = occlude_partly(f, Vec3{1, 2, 3}, T(0.1), T(0.95));
    f = pass_through(f, s, covariance::Sym2<T>{1, 0, 2});
    f.sigma = absorb(f.sigma, slab_gradient(f.frame, s.n, map.n, T(2), T(0.5)));
    f = surface_enter(f, s, map);
    f = reflect_glossy(f, shading_surface(s, map), Vec3{0.1, 0.2, 0.97},
                       roughened(micro_ggx(T(0.3), T(0.4)), {T(0.01), 0, T(0.02)}));
    f = surface_exit(f, s, map);
    f = travel(f, T(0.5));
    f = scatter_in_volume(f, Vec3{0, 0.6, 0.8}, n(10) * T(0.9));
    return rotate_to(f, frame_along<T>(f.frame.z)).sigma;
}

RC_GTEST_PROP(Rules, FloatIsDoubleRounded, ()) {
    std::array<double, 12> r;
    for (double& x : r) x = draw(-1, 1);
    const auto exact = through_everything<double>(r);
    const auto single = through_everything<float>(r);
    Matrix widened;
    for (std::size_t i = 0; i < 15; ++i) widened.values[i] = static_cast<double>(single.values[i]);
    RC_ASSERT(is_psd(exact, largest(exact)));
    RC_ASSERT(distance(widened, exact) < 1e-3);
}

}  // namespace
}  // namespace support
