/// Properties of lights for the frequency analysis: sizes, borders, curvature, motion.
#include <gtest/gtest.h>

#include "core/rng.h"
#include "light/border.h"
#include "light_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

/// The spectrum at the point of the scene's only shape that a ray from `from` towards `at` meets.
SourceSpectrum spectrum_at(LightScene& s, Vec3 from, Vec3 at, float time = 0) {
    if (!s.lights) s.build_with_spectra();
    SurfaceHit hit;
    EXPECT_TRUE(s.geometry->intersect({from, normalize(at - from), time}, hit));
    return s.spectra->source_spectrum(hit, true);
}

/// Second moment along a unit direction of the tangent plane.
float moment(const SourceSpectrum& s, Vec3 direction) {
    const Vec3 d = s.tangent.to_local(direction);
    return s.s11 * d.x * d.x + 2 * s.s12 * d.x * d.y + s.s22 * d.y * d.y;
}

Vec3 border_point(const SourceSpectrum& s, Vec3 p) {
    return p + (s.tangent.x * s.border_direction.x + s.tangent.y * s.border_direction.y) *
                   s.border_distance;
}

TEST(SourceSpectrum, RectangleMomentsAndBorder) {
    LightScene s;
    s.add(mesh_of(rectangle(2, 6)), Rgb(1));
    const Vec3 p{0.7f, 1, 0};
    const SourceSpectrum a = spectrum_at(s, {0.7f, 1, 5}, p);
    EXPECT_EQ(a.kind, SourceSpectrum::Kind::area);
    EXPECT_GT(a.tangent.z.z, 0.999f);
    EXPECT_NEAR(moment(a, {1, 0, 0}), 4.0 / 12, 1e-5);
    EXPECT_NEAR(moment(a, {0, 1, 0}), 36.0 / 12, 1e-4);
    EXPECT_NEAR(a.border_distance, 0.3, 1e-5);
    EXPECT_LT(distance(border_point(a, p), {1, 1, 0}), 1e-5f)
        << "the diagonal between the triangles is no border";
    EXPECT_EQ(a.k11, 0);
    EXPECT_EQ(a.velocity, Vec3{});
}

TEST(SourceSpectrum, RectangleRotatedAndScaled) {
    const Transform t = Transform::translate({3, 2, 1}) * Transform::rotate(40, {1, 2, 3}) *
                        Transform::scale(2, 0.5, 7);
    LightScene s;
    s.add(mesh_of(rectangle(2, 6), AnimatedTransform(t)), Rgb(1));
    const Vec3 p = t.point({0.5f, -2.8f, 0});
    const Vec3 n = normalize(t.normal({0, 0, 1}));
    const SourceSpectrum a = spectrum_at(s, p + n * 3, p);
    EXPECT_NEAR(moment(a, normalize(t.vector({1, 0, 0}))), 16.0 / 12, 1e-4);
    EXPECT_NEAR(moment(a, normalize(t.vector({0, 1, 0}))), 9.0 / 12, 1e-4);
    EXPECT_NEAR(a.border_distance, 0.1, 1e-4);
    EXPECT_LT(distance(border_point(a, p), t.point({0.5f, -3, 0})), 1e-3f);
}

TEST(SourceSpectrum, TriangleMomentsFollowTheFormula) {
    TriangleMesh m;
    m.positions = {{0, 0, 0}, {3, 0, 0}, {1, 2, 0}};
    m.triangles = {{0, 1, 2}};
    LightScene s;
    s.add(mesh_of(m), Rgb(1));
    const SourceSpectrum a = spectrum_at(s, {1.2f, 0.5f, 3}, {1.2f, 0.5f, 0});
    // The moments are (1/12) sum of (v - c)(v - c)^T about the centroid (4/3, 2/3).
    const double xx = (16.0 / 9 + 25.0 / 9 + 1.0 / 9) / 12,
                 yy = (4.0 / 9 + 4.0 / 9 + 16.0 / 9) / 12;
    const double xy = (8.0 / 9 - 10.0 / 9 - 4.0 / 9) / 12;
    EXPECT_NEAR(moment(a, {1, 0, 0}), xx, 1e-5);
    EXPECT_NEAR(moment(a, {0, 1, 0}), yy, 1e-5);
    EXPECT_NEAR(moment(a, normalize(Vec3{1, 1, 0})), (xx + yy) / 2 + xy, 1e-5);
}

TEST(SourceSpectrum, SpheresLookLikeDiscsAndAreCurved) {
    for (const bool reverse : {false, true}) {
        LightScene s;
        ShapeDescription d =
            shape_of(whole_sphere(0.5f), AnimatedTransform(Transform::scale(4, 4, 4)));
        d.reverse_orientation = reverse;
        s.add(d, Rgb(1), true);
        const SourceSpectrum a = spectrum_at(s, {3, 4, 5}, {0.3f, 0, 0.2f});
        EXPECT_NEAR(a.s11, 1, 1e-4);
        EXPECT_NEAR(a.s22, 1, 1e-4);
        EXPECT_NEAR(a.s12, 0, 1e-4);
        EXPECT_NEAR(a.k11, reverse ? -0.5 : 0.5, 1e-5);
        EXPECT_EQ(a.k22, a.k11);
        EXPECT_EQ(a.border_distance, kInfinity);
    }
}

TEST(SourceSpectrum, DisksAndRings) {
    LightScene s, ring;
    s.add(shape_of(Disk{1, 2, 0, 360}), Rgb(1));
    const SourceSpectrum a = spectrum_at(s, {0.5f, 0, 3}, {0.5f, 0, 1});
    EXPECT_NEAR(a.s11, 1, 1e-3);
    EXPECT_NEAR(a.s22, 1, 1e-3);
    EXPECT_NEAR(a.border_distance, 1.5, 1e-5);
    EXPECT_LT(distance(border_point(a, {0.5f, 0, 1}), {2, 0, 1}), 1e-4f);
    ring.add(shape_of(Disk{0, 2, 1, 180}), Rgb(1));
    EXPECT_NEAR(spectrum_at(ring, {0, 1.2f, 3}, {0, 1.2f, 0}).border_distance, 0.2, 1e-5)
        << "inner rim";
    EXPECT_NEAR(spectrum_at(ring, {1.5f, 0.1f, 3}, {1.5f, 0.1f, 0}).border_distance, 0.1, 1e-5)
        << "straight cut";
}

TEST(SourceSpectrum, ClosedMeshesHaveNoBorder) {
    LightScene s;
    s.add(mesh_of(cube()), Rgb(1));
    const SourceSpectrum a = spectrum_at(s, {0.2f, 0.3f, 5}, {0.2f, 0.3f, 1});
    EXPECT_EQ(a.border_distance, kInfinity);
    // The surface is a cube's of side 2: four sides give 1/3 along x, two give 1, by equal areas.
    EXPECT_NEAR(moment(a, {1, 0, 0}), (4.0 / 3 + 2) / 6, 1e-4);
}

TEST(SourceSpectrum, MotionMovesTheTensorAndGivesVelocities) {
    const Transform start = Transform::translate({0, 0, 1});
    const Transform end = Transform::translate({2, 0, 1}) * Transform::rotate(90, {0, 0, 1});
    LightScene s;
    s.add(mesh_of(rectangle(2, 6), AnimatedTransform(start, 0, end, 1)), Rgb(1));
    const Vec3 p{1, 0, 1};
    const SourceSpectrum a = spectrum_at(s, {1, 0, 5}, p, 0.5f);
    const float h = std::sqrt(0.5f);
    EXPECT_NEAR(moment(a, {h, h, 0}), 4.0 / 12, 1e-3);
    EXPECT_NEAR(moment(a, {-h, h, 0}), 36.0 / 12, 1e-3);
    EXPECT_NEAR(a.border_distance, 1, 1e-3);
    EXPECT_NEAR(a.velocity.x, 2, 1e-2);
    EXPECT_NEAR(a.angular_velocity.z, kPi / 2, 1e-3);
}

TEST(SourceSpectrum, SamplesAndHitsTellTheSame) {
    LightScene s;
    s.add(mesh_of(rectangle(2, 6)), Rgb(1));
    s.build_with_spectra();
    Rng rng(1);
    for (int i = 0; i < 100; ++i) {
        const auto sample = s.lights->sample({0.3f, 0.2f, 2}, {}, 0, 0.5f, rng.next_2d());
        ASSERT_TRUE(sample);
        SurfaceHit hit;
        ASSERT_TRUE(s.geometry->intersect({{0.3f, 0.2f, 2}, sample->wi}, hit));
        const SourceSpectrum a = s.spectra->source_spectrum(*sample, 0),
                             b = s.spectra->source_spectrum(hit, true);
        EXPECT_EQ(a.border_distance, kInfinity);
        EXPECT_LT(b.border_distance, 1.001f);
        EXPECT_NEAR(a.s11, b.s11, 1e-5);
    }
}

TEST(SourceSpectrum, LightsWithoutExtent) {
    LightScene s;
    s.add_light(PointLight{.intensity = Rgb(1), .power = {}, .from = {0, 0, 3}});
    s.add_light(SpotLight{.intensity = Rgb(1),
                          .power = {},
                          .from = {0, 0, 3},
                          .to = {},
                          .cone_angle = 10,
                          .cone_delta_angle = 0});
    s.add_light(DistantLight{});
    s.build_with_spectra();
    bool seen[3] = {};
    for (int i = 0; i < 300; ++i) {
        const auto sample = s.lights->sample({}, {0, 0, 1}, 0, float(i) / 300, {});
        ASSERT_TRUE(sample && sample->is_delta);
        seen[sample->light] = true;
        const SourceSpectrum a = s.spectra->source_spectrum(*sample, 0);
        EXPECT_LT(distance(a.tangent.z, -sample->wi), 1e-5f);
        if (sample->light == 2) {
            EXPECT_EQ(a.kind, SourceSpectrum::Kind::directional);
            EXPECT_EQ(a.a11, 1e8f);
            EXPECT_EQ(a.a22, 1e8f);
            continue;
        }
        EXPECT_EQ(a.kind, SourceSpectrum::Kind::point);
        // A uniform cone of half angle c has variance c^2 / 4 along one axis.
        EXPECT_NEAR(a.cone_variance, sample->light == 1 ? sqr(10 * kPi / 180) / 4 : 0, 1e-4);
    }
    EXPECT_TRUE(seen[0] && seen[1] && seen[2]);
}

TEST(BorderEdges, FindTheNearestOfMany) {
    // The border is that of a staircase of separate triangles: all edges are borders.
    std::vector<std::array<Vec3, 3>> triangles;
    Rng rng(7);
    for (int i = 0; i < 500; ++i) {
        const auto corner = [&] {
            const Vec2 a = rng.next_2d();
            return Vec3{a.x, a.y, rng.next_float()} * 10;
        };
        const Vec3 a = corner();
        triangles.push_back({a, a + corner() * 0.05f, a + corner() * 0.05f});
    }
    const BorderEdges border(triangles);
    EXPECT_EQ(border.count(), 1500u);
    for (int i = 0; i < 500; ++i) {
        const Vec2 a = rng.next_2d();
        const Vec3 p = Vec3{a.x, a.y, rng.next_float()} * 12;
        float expected = kInfinity;
        for (const auto& t : triangles)
            for (size_t k = 0; k < 3; ++k) {
                const Vec3 from = t[k], d = t[(k + 1) % 3] - from;
                const float along = clamp01(dot(p - from, d) / dot(d, d));
                expected = std::min(expected, distance(p, from + d * along));
            }
        const auto nearest = border.nearest(p);
        ASSERT_TRUE(nearest);
        ASSERT_NEAR(distance(*nearest, p), expected, 1e-4);
    }
    EXPECT_FALSE(BorderEdges().nearest({}));
}

/// The largest variance in any direction of a projector's light towards `w`.
double slide_variance(const TemporaryImage& image, Vec3 towards) {
    LightScene s;
    ProjectionLight light;
    light.image = image.path();
    light.fov = 60;
    s.add_light(light);
    s.build_with_spectra();
    const auto sample = s.lights->sample(towards, {}, 0, 0.5f, {0.5f, 0.5f});
    EXPECT_TRUE(sample);
    const SourceSpectrum a = s.spectra->source_spectrum(*sample, 0);
    EXPECT_EQ(a.kind, SourceSpectrum::Kind::point);
    const double half = 0.5 * (double(a.a11) + a.a22), difference = 0.5 * (double(a.a11) - a.a22);
    return half + std::sqrt(difference * difference + double(a.a12) * a.a12);
}

TEST(SourceSpectrum, AProjectorsSlideHasItsAngularFrequencies) {
    // The image has waves of 8 texels of 64: 8 cycles over 2 tan 30, 6.93 per radian in the middle.
    constexpr int n = 64;
    const auto waves = [](float cycles) {
        std::vector<Rgb> texels;
        for (int i = 0; i < n * n; ++i)
            texels.push_back(
                Rgb(0.5f + 0.25f * std::sin(2 * kPi * cycles * (float(i % n) + 0.5f) / n)));
        return texels;
    };
    const TemporaryImage coarse(waves(4), n, n), fine(waves(8), n, n);
    const double frequency = 8 / (2 * std::tan(kPi / 6));
    const double measured = slide_variance(fine, {0, 0, 1});
    EXPECT_GT(measured, 0.8 * frequency * frequency);
    EXPECT_LT(measured, 3 * frequency * frequency);
    // Half the frequency has a quarter of the variance.
    EXPECT_NEAR(measured / slide_variance(coarse, {0, 0, 1}), 4, 1.2);
    const TemporaryImage plain(std::vector<Rgb>(n * n, Rgb(0.5f)), n, n);
    EXPECT_LT(slide_variance(plain, {0, 0, 1}), 0.01 * measured);
    // The border against the dark counts near the rim.
    EXPECT_GT(slide_variance(plain, normalize(Vec3{0.95f * std::tan(kPi / 6), 0, 1})),
              slide_variance(plain, {0, 0, 1}) + 10);
}

}  // namespace
}  // namespace covtrace
