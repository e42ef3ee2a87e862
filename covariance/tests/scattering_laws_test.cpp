// Laws of operators that multiply or convolve the light: lobes, windows, textures, occluders,
// sources, sums.
#include "support.h"

namespace support {
namespace {

using namespace covariance;

/// The inverse C^-1 placed in the rows and columns u, v.
Matrix angular_inverse(const Sym2& c) {
    Matrix m;
    m.set_angular(inverse(c));
    return m;
}

RC_GTEST_PROP(Convolution, EqualsTheInverseFormWhereThatExists, ()) {
    const Matrix s = draw_pd();
    const Sym2 c = draw_pd2();
    const Matrix expected = support::inverse(support::inverse(s) + angular_inverse(c));
    RC_ASSERT(distance(convolve_angular(s, c), expected, largest(s)) < 1e-9);
}

RC_GTEST_PROP(Convolution, TwiceIsOnceWithTheHarmonicSumOfTheLobes, ()) {
    const Matrix s = draw_psd();
    const Sym2 c1 = draw_pd2(), c2 = draw_pd2();
    const Sym2 both = inverse(inverse(c1) + inverse(c2));
    RC_ASSERT(distance(convolve_angular(convolve_angular(s, c1), c2), convolve_angular(s, both),
                       largest(s)) < 1e-10);
}

RC_GTEST_PROP(Convolution, NeverAddsFrequencies, ()) {
    const Matrix s = draw_psd();
    const Sym2 c = draw_pd2();
    const Matrix after = convolve_angular(s, c);
    RC_ASSERT(is_psd(after, trace(s)));
    RC_ASSERT(is_psd(s - after, trace(s)));
}

RC_GTEST_PROP(Convolution, ZeroKernelIsTheExactSlice, ()) {
    const Matrix s = draw_psd();
    const Matrix slice = convolve_angular(s, Sym2{});
    for (std::size_t i = 0; i < 5; ++i) {
        RC_ASSERT(slice(i, axis::u) == 0.0);
        RC_ASSERT(slice(i, axis::v) == 0.0);
    }
    RC_ASSERT(is_psd(slice, trace(s)));
    RC_ASSERT(convolve_angular(slice, Sym2{}) == slice);
}

RC_GTEST_PROP(Convolution, SharpLobeChangesNothing, ()) {
    const Matrix s = draw_psd();
    RC_ASSERT(distance(convolve_angular(s, Sym2::diagonal(1e13, 1e13)), s) < 1e-10);
}

TEST(Convolution, KeepsTheAngleOfAPointLightFarAway) {
    // Very high frequencies arrive; those that leave are the lobe's, not rounding noise.
    const Field far = travel(point_source(Frame{}, 1e-4), 500);
    const Matrix after = convolve_angular(far.sigma, Sym2::diagonal(0.2, 0.3));
    EXPECT_NEAR(after(2, 2), 0.2, 1e-6);
    EXPECT_NEAR(after(3, 3), 0.3, 1e-6);
}

RC_GTEST_PROP(Convolution, AcceptsSingularKernelsAndFields, ()) {
    const double a = draw(-2, 2), b = draw(-2, 2);
    const Matrix s = draw_psd();
    RC_ASSERT(is_psd(convolve_angular(s, Sym2{a * a, a * b, b * b}), trace(s)));
    RC_ASSERT(convolve_angular(Matrix{}, Sym2{a * a, a * b, b * b}) == Matrix{});
}

RC_GTEST_PROP(Convolution, CommutesWithTexture, ()) {
    const Matrix s = draw_psd();
    const Sym2 c = draw_pd2(), t = draw_pd2();
    RC_ASSERT(distance(convolve_angular(add_texture(s, t), c),
                       add_texture(convolve_angular(s, c), t)) < 1e-11);
}

RC_GTEST_PROP(Blocks, PseudoInverseIsAGeneralisedInverse, ()) {
    const double a = draw(-2, 2), b = draw(-2, 2);
    for (const Sym2& m : {draw_pd2(), Sym2{a * a, a * b, b * b}, Sym2{}}) {
        const Mat2 back = Mat2(m) * Mat2(pseudo_inverse(m)) * Mat2(m);
        RC_ASSERT(std::abs(back.m00 - m.xx) < 1e-10);
        RC_ASSERT(std::abs(back.m01 - m.xy) < 1e-10);
        RC_ASSERT(std::abs(back.m11 - m.yy) < 1e-10);
    }
}

RC_GTEST_PROP(Blocks, EigenvaluesRebuildTheMatrix, ()) {
    const Sym2 m{draw(-3, 3), draw(-3, 3), draw(-3, 3)};
    const auto same = map_eigenvalues(m, [](double l) { return l; });
    RC_ASSERT(distance(m, same) < 1e-13);
    const auto e = eigen(m);
    RC_ASSERT(std::abs(e.high * e.low - det(m)) < 1e-12);
    RC_ASSERT(std::abs(e.x * e.x + e.y * e.y - 1) < 1e-13);
}

// ---- sums

RC_GTEST_PROP(Sums, HarmonicSumEqualsTheInverseForm, ()) {
    const Matrix a = draw_pd(), b = draw_pd();
    const Matrix expected = support::inverse(support::inverse(a) + support::inverse(b));
    RC_ASSERT(distance(harmonic_sum(a, b), expected, largest(a)) < 1e-9);
    RC_ASSERT(distance(harmonic_sum(a, b), harmonic_sum(b, a), std::max(largest(a), largest(b))) <
              1e-10);
}

RC_GTEST_PROP(Sums, HarmonicSumTakesSingularMatrices, ()) {
    const Matrix a = draw_psd();
    RC_ASSERT(distance(harmonic_sum(a, a), 0.5 * a, largest(a)) < 1e-9);
    RC_ASSERT(distance(harmonic_sum(a, Matrix{}), Matrix{}, largest(a)) < 1e-9);
}

RC_GTEST_PROP(Sums, AverageIsWeightedAndMergesExactly, ()) {
    const Matrix a = draw_psd(), b = draw_psd();
    const double wa = draw(0.1, 3), wb = draw(0.1, 3);
    Accumulator<double> sum, first, second;
    sum.add(a, wa);
    sum.add(b, wb);
    first.add(a, wa);
    second.add(b, wb);
    first.merge(second);
    RC_ASSERT(first.mean() == sum.mean());
    RC_ASSERT(distance(sum.mean(), (wa / (wa + wb)) * a + (wb / (wa + wb)) * b) < 1e-14);
    RC_ASSERT(is_psd(sum.mean()));
    RC_ASSERT(Accumulator<double>::from_sum(sum.sum(), sum.weight()).mean() == sum.mean());
}

RC_GTEST_PROP(Sums, MergeDoesNotDependOnTheFrameOfTheOther, ()) {
    const Frame f = draw_frame(draw_direction());
    const Field a{draw_psd(), f}, b{draw_psd(), f};
    const double wa = draw(0.1, 3), wb = draw(0.1, 3);
    const Field merged = merge(a, wa, rotate_to(b, draw_frame_like(f)), wb);
    RC_ASSERT(distance(merged.sigma, merge(a, wa, b, wb).sigma) < 1e-12);
    RC_ASSERT(merge(a, 0, b, 0) == a);
    RC_ASSERT(distance(merge(a, 0, b, wb).sigma, b.sigma) < 1e-12);
}

TEST(Sums, RejectsWhatIsNotAContribution) {
    Accumulator<double> sum;
    Matrix broken;
    broken(1, 3) = std::nan("");
    EXPECT_FALSE(sum.add(broken, 1));
    EXPECT_FALSE(sum.add(Matrix{}, 0));
    EXPECT_FALSE(sum.add(Matrix{}, -1));
    EXPECT_FALSE(sum.add(Matrix{}, std::nan("")));
    EXPECT_FALSE(sum.add(Matrix{}, INFINITY));
    EXPECT_EQ(sum.weight(), 0);
    EXPECT_EQ(sum.mean(), Matrix{});
}

// ---- reflection and refraction

RC_GTEST_PROP(Reflection, MirroredFrameMakesTheAngularMapTheIdentity, ()) {
    const Frame in = draw_frame(draw_direction());
    const Surface hit = draw_surface(in.z);
    const Vec3 leaving = draw_leaving(hit.n);  // anywhere: the half vector takes the normal's part
    const Vec3 h = half_vector(in.z, leaving, hit.n);
    RC_PRE(std::abs(dot(h, in.z)) > 0.05);
    const Frame out = mirrored(in, h);
    RC_ASSERT(length(out.z - leaving) < 1e-12);
    const Mat2 map = specular_map(in, out, tilted(hit, h), 1.0, 1.0);
    RC_ASSERT(std::abs(map.m00 - 1) + std::abs(map.m01) + std::abs(map.m10) +
                  std::abs(map.m11 - 1) <
              1e-9);
}

TEST(Reflection, AlignedLobeNarrowsAcrossThePlaneAtGrazing) {
    const double c = 0.6, s = 0.8;
    const Surface hit;
    const Frame in{{c, 0, s}, {0, 1, 0}, {s, 0, -c}};
    const Vec3 h = half_vector(in.z, Vec3{s, 0, c}, hit.n);
    const Sym2 micro = micro_beckmann(0.1, 0.3);
    const Sym2 lobe = glossy_lobe(mirrored(in, h), hit, h, micro);
    EXPECT_NEAR(lobe.xx, micro.xx / 4, 1e-12);
    EXPECT_NEAR(lobe.xy, 0, 1e-12);
    EXPECT_NEAR(lobe.yy, micro.yy / (4 * c * c), 1e-12);
}

RC_GTEST_PROP(Reflection, IsotropicLobeIsThatOfAnyTangents, ()) {
    const Frame in = draw_frame(draw_direction());
    const Surface hit = draw_surface(in.z);
    const Vec3 h = half_vector(in.z, draw_leaving(hit.n), hit.n);
    const Frame out = mirrored(in, h);
    const double alpha = draw(0.05, 1), cos_h = std::abs(dot(h, out.z));
    RC_PRE(cos_h > 0.05);
    const Sym2 micro = micro_ggx(alpha, alpha), lobe = glossy_lobe(out, hit, h, micro);
    const Sym2 general = reflection_cov(micro, surface_projection(out, tilted(hit, h)), cos_h);
    RC_ASSERT(std::abs(lobe.xx - general.xx) + std::abs(lobe.xy - general.xy) +
                  std::abs(lobe.yy - general.yy) <
              1e-10 * trace(general));
}

RC_GTEST_PROP(Reflection, DiffuseForgetsDirections, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const Surface hit = draw_surface(field.frame.z);
    const Vec3 leaving = draw_leaving(hit.n);
    const Field out = reflect_diffuse(surface_enter(field, hit), hit, leaving);
    RC_ASSERT(out.sigma.angular() == Sym2{});
    RC_ASSERT(is_psd(out.sigma, trace(field.sigma)));
    RC_ASSERT(length(out.frame.z - leaving) < 1e-14);
    // Any outgoing frame gives the same light.
    const Field one = surface_exit(out, hit);
    const Field two = surface_exit(out, hit, draw_frame_like(out.frame));
    RC_ASSERT(distance(rotate_to(two, one.frame).sigma, one.sigma) < 1e-10);
}

RC_GTEST_PROP(Refraction, RoughAtThePairOfSnellIsSmoothAndALobe, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const Surface hit = draw_surface(field.frame.z);
    const double n1 = 1, n2 = draw(1.2, 2), eta = n1 / n2;
    const double c1 = -dot(field.frame.z, hit.n), c2 = std::sqrt(1 - eta * eta * (1 - c1 * c1));
    const Vec3 leaving = eta * field.frame.z + (eta * c1 - c2) * hit.n;
    const Sym2 micro = micro_ggx(0.2, 0.4);
    const Field smooth = refract(field, hit, leaving, n1, n2);
    const Sym2 lobe = refraction_cov(micro, surface_projection(smooth.frame, hit), c1, c2, n1, n2);
    RC_ASSERT(distance(refract_glossy(field, hit, leaving, n1, n2, micro).sigma,
                       convolve_angular(smooth, lobe).sigma, largest(smooth.sigma)) < 1e-8);
    RC_ASSERT(distance(refract_glossy(field, hit, field.frame.z, 1.3, 1.3, micro).sigma,
                       field.sigma) < 1e-9);
}

TEST(Lobes, CosineWindowFollowsThePlaneOfIncidence) {
    const double w = 1 / (M_PI * M_PI);
    EXPECT_NEAR(cosine_window(Frame{}, Vec3{0, 0, 1}).xx, w, 1e-15);
    const double c = 0.5, s = std::sqrt(0.75);
    const Frame in{{c, 0, s}, {0, 1, 0}, {s, 0, -c}};
    const Sym2 tilted_window = cosine_window(in, Vec3{0, 0, 1});
    EXPECT_NEAR(tilted_window.xx, w / (c * c), 1e-14);
    EXPECT_NEAR(tilted_window.xy, 0, 1e-15);
    EXPECT_NEAR(tilted_window.yy, w, 1e-15);
    const Frame grazing{{0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
    EXPECT_NEAR(cosine_window(grazing, Vec3{0, 0, 1}).xx, w / (0.05 * 0.05), 1e-9);
}

// ---- occluders and sources

RC_GTEST_PROP(Occlusion, EdgeIsRankOneAndSeenAlongOneMinusZMinusV, ()) {
    const double phi = draw(0, 6.28), r = draw(0.05, 2), z = draw(0, 3);
    const double vx = draw(-2, 2), vy = draw(-2, 2);
    const double dx = std::cos(phi), dy = std::sin(phi), q = 1 / (M_PI * M_PI * r * r);
    const double w[5]{dx, dy, -z * dx, -z * dy, -(dx * vx + dy * vy)};
    Matrix expected;
    for (std::size_t i = 0; i < 5; ++i)
        for (std::size_t j = i; j < 5; ++j) expected(i, j) = q * w[i] * w[j];
    RC_ASSERT(distance(travel(occlude(Matrix{}, dx, dy, r, vx, vy), z), expected) < 1e-12);
}

RC_GTEST_PROP(Occlusion, WorldFormProjectsOntoTheRay, ()) {
    const Field field{draw_psd(), draw_frame(draw_direction())};
    const double phi = draw(0, 6.28), r = draw(0.05, 2), vx = draw(-2, 2), vy = draw(-2, 2);
    const Frame& f = field.frame;
    const Vec3 across = std::cos(phi) * f.x + std::sin(phi) * f.y;
    const Vec3 velocity = vx * f.x + vy * f.y + 3.0 * f.z;
    const Field seen = occlude(field, r * across + 0.7 * f.z, 1e-3, velocity);
    RC_ASSERT(distance(seen.sigma, occlude(field.sigma, std::cos(phi), std::sin(phi), r, vx, vy)) <
              1e-11);
    RC_ASSERT(is_psd(seen.sigma));
    const Field tensor = occlude(field, Sym3<double>{}.add_outer(across, 2.5), r, velocity);
    RC_ASSERT(distance(tensor.sigma, seen.sigma) < 1e-11);
    // An occluder centred on the ray has no direction, and adds a finite amount.
    const Field centred = occlude(field, Vec3{}, 0.1);
    RC_ASSERT(std::abs(centred.sigma(0, 0) - field.sigma(0, 0) - 0.5 * edge_variance(0.1)) < 1e-9);
}

TEST(Texture, CheckerboardUsesTheDistanceOfBothAxes) {
    const Sym2 t = checkerboard_texture(0.1, 0.3, 0.2);
    EXPECT_DOUBLE_EQ(t.xx, edge_variance(0.2));
    EXPECT_DOUBLE_EQ(t.yy, edge_variance(0.3));
    EXPECT_DOUBLE_EQ(t.xy, 0);
    const Sym2 stretched = texture_on_surface(t, Mat2{2, 0, 0, 1});
    EXPECT_DOUBLE_EQ(stretched.xx, 4 * t.xx);
    EXPECT_DOUBLE_EQ(image_texture(Sym2{1, 0, 1}, 0.05).xx, 0.5 / (2 * M_PI * M_PI));
    EXPECT_DOUBLE_EQ(image_texture(Sym2{1, 0, 1}, 0.5).xx, 1 / (2 * M_PI * M_PI));
    EXPECT_EQ(sharper(t, stretched), stretched);
}

RC_GTEST_PROP(Sources, RectangleIsTwoTriangles, ()) {
    const double a = draw(0.1, 3), b = draw(0.1, 3);
    const Vec3 p{0, 0, 0}, q{a, 0, 0}, r{a, b, 0}, s{0, b, 0}, x{1, 0, 0}, y{0, 1, 0};
    // The moments are those of each triangle about its own centroid, and of the centroids about the
    // centre.
    const Sym2 one = triangle_moments(p, q, r, x, y), two = triangle_moments(p, r, s, x, y);
    const double dx = a / 6, dy = b / 6;
    const Sym2 apart{dx * dx, -dx * dy, dy * dy};
    RC_ASSERT(distance(0.5 * (one + two) + apart, rectangle_moments(a, b)) < 1e-12);
}

TEST(Sources, DegenerateEmittersAreCapped) {
    const Field flat = area_source(rectangle_moments(1.0, 0.0), Frame{});
    EXPECT_DOUBLE_EQ(flat.sigma(0, 0), 3 / (M_PI * M_PI));
    EXPECT_DOUBLE_EQ(flat.sigma(1, 1), max_source_variance<double>);
    EXPECT_NEAR(point_source(Frame{}, 1e-3).sigma(0, 0), 1e6 / (4 * M_PI * M_PI), 1e-6);
    EXPECT_DOUBLE_EQ(directional_source(Frame{}).sigma(2, 2), max_source_variance<double>);
    EXPECT_DOUBLE_EQ(spot_window(0.5).xx, 1 / (M_PI * M_PI));
}

RC_GTEST_PROP(Sources, FarSphereIsASun, ()) {
    const double radius = draw(0.1, 2), distance_to = draw(50, 500);
    const Field far = travel(area_source(sphere_moments(radius), Frame{}), distance_to);
    const Field sun = sun_source(Frame{}, radius / distance_to);
    RC_ASSERT(std::abs(far.sigma(2, 2) / sun.sigma(2, 2) - 1) < 1e-12);
}

TEST(Occlusion, FootprintIsTheWidestExtent) {
    EXPECT_DOUBLE_EQ(footprint_radius(Matrix::diagonal(4, 1, 0, 0, 0)), 1 / (2 * M_PI));
    EXPECT_EQ(footprint_radius(Matrix{}), INFINITY);
}

}  // namespace
}  // namespace support
