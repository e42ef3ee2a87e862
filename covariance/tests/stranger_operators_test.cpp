// Operators and conveniences that a small path tracer asks for by other names: light from infinity,
// lamps in view, solid textures, fuzzy mirrors, vectors.
#include <random>

#include "support.h"

namespace support {
namespace {

using namespace covariance;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

RC_GTEST_PROP(LightFromInfinity, StaysAsItIs, ()) {
    const Frame frame = draw_frame(draw_direction());
    const Field sky = distant_source(frame, draw_pd2());
    RC_ASSERT(travel(sky, kInfinity) == sky);
    RC_ASSERT(travel(sun_source(frame, 0.005), kInfinity) == sun_source(frame, 0.005));
    RC_ASSERT(distance(travel(sky, 1e6).sigma, sky.sigma) == 0);
}

TEST(LightFromInfinity, OtherLightHasNoAnswerThere) {
    const Field lamp = point_source(frame_along<double>(Vec3{0, 0, 1}), 0.1);
    EXPECT_FALSE(is_finite(travel(lamp, kInfinity).sigma));
}

/// Covariance of a signal with a positive spectrum on a plane: -Hess g/(4 pi^2 g) at 0 by central
/// differences.
template <typename Signal>
Sym2 measured(const Signal& g, double h) {
    const double at = g(0, 0);
    const auto second = [&](double a, double b) {
        return (g(a, b) - 2 * at + g(-a, -b)) / (h * h);
    };
    const double xx = second(h, 0), yy = second(0, h), both = second(h, h);
    return (-1 / (four_pi_sq<double> * at)) * Sym2{xx, (both - xx - yy) / 2, yy};
}

/// Waves in space with positive amplitudes, cut by a plane in any direction.
RC_GTEST_PROP(SolidTexture, IsTheBlockOfTheTangents, ()) {
    struct Wave {
        Vec3 frequency;
        double amplitude;
    };
    std::vector<Wave> waves;
    Sym3<double> solid;
    double sum = 0;
    for (int i = 0; i < 8; ++i) {
        waves.push_back({draw_vec3(2), draw(0.1, 1)});
        sum += waves.back().amplitude;
    }
    for (const Wave& w : waves) solid.add_outer(w.frequency, w.amplitude / sum);
    const Surface surface = draw_surface(draw_direction());
    const auto on_plane = [&](double a, double b) {
        double value = 0;
        for (const Wave& w : waves)
            value += w.amplitude *
                     std::cos(2 * M_PI * dot(w.frequency, a * surface.t1 + b * surface.t2));
        return value;
    };
    RC_ASSERT(distance(solid_texture(solid, surface), measured(on_plane, 1e-3)) < 1e-3);
}

TEST(SolidTexture, NoiseHasAThirdOfItsSquaredFrequencyAlongEveryAxis) {
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    Sym3<double> mean;
    const int waves = 20000;
    for (int i = 0; i < waves; ++i) {
        const Vec3 w = 3.0 * normalize(Vec3{normal(random), normal(random), normal(random)});
        mean.add_outer(w, 1.0 / waves);
    }
    const Sym3<double> noise = solid_noise(3.0);
    EXPECT_NEAR(mean.xx, noise.xx, 0.1);
    EXPECT_NEAR(mean.yy, noise.yy, 0.1);
    EXPECT_NEAR(mean.zz, noise.zz, 0.1);
    EXPECT_NEAR(mean.xy, noise.xy, 0.1);
}

TEST(SolidTexture, ChecksOnAFloorAreACheckerboard) {
    const Surface floor{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {}};
    EXPECT_EQ(solid_texture(solid_checkerboard(Vec3{0.1, 0.2, 0.3}, 0.01), floor),
              checkerboard_texture(0.1, 0.2, 0.01));
}

/// Gaussian light off a fuzzy mirror: variances of directions add. The mirror draws 400 000
/// directions from a fixed seed; the tolerance is 5 standard deviations of a variance.
TEST(FuzzyMirror, VarianceOfItsLobeIsThatOfTheDrawnDirections) {
    const double fuzz = 0.05, light = 0.02;  // standard deviation of the light's slopes
    std::mt19937 random(2);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(-1, 1);
    const int n = 400000;
    double sum = 0;
    for (int i = 0; i < n; ++i) {
        Vec3 ball;
        do ball = {uniform(random), uniform(random), uniform(random)};
        while (dot(ball, ball) > 1);
        const Vec3 mirror = normalize(Vec3{light * normal(random), light * normal(random), 1});
        const Vec3 leaving = normalize(mirror + fuzz * ball);
        sum += (leaving.x / leaving.z) * (leaving.x / leaving.z) / n;
    }
    const Surface surface{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {}};
    const double spectrum = 1 / (four_pi_sq<double> * light * light);
    const Field arriving =
        distant_source(frame_along<double>(Vec3{0, 0, -1}), Sym2::diagonal(spectrum, spectrum));
    const Field leaving = reflect_fuzzy(arriving, surface, Vec3{0, 0, 1}, fuzz);
    const double predicted = 1 / (four_pi_sq<double> * leaving.sigma(2, 2));
    EXPECT_NEAR(predicted / sum, 1, 5 * std::sqrt(2.0 / n) + fuzz * fuzz);
    EXPECT_EQ(reflect_fuzzy(arriving, surface, Vec3{0, 0, 1}, 0),
              reflect_specular(arriving, surface, Vec3{0, 0, 1}));
}

/// A lamp in a mirror: the filter beside its border is narrower than the lamp's moments alone say,
/// and the mirror changes nothing of that.
TEST(LampInView, ItsBorderReachesTheCameraThroughAMirror) {
    const Surface lamp{{0, 0, -1}, {1, 0, 0}, {0, 1, 0}, {}};
    const Surface mirror{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {}};
    const Frame down = frame_along<double>(Vec3{0, 0, -1});
    const auto seen = [&](const Field& field) {
        Field f = travel(surface_exit(field, lamp), 2);
        f = surface_exit(reflect_specular(surface_enter(f, mirror), mirror, Vec3{0, 0, 1}), mirror);
        return travel(f, 1).sigma;
    };
    const Sym2 moments = rectangle_moments(2.0, 2.0),
               border = rectangle_border(2.0, 2.0, 0.9, 0.0, 1e-4);
    const Matrix with = seen(area_source_in_view(moments, border, down)),
                 without = seen(area_source(moments, down));
    // A pinhole sees the deviation in slopes 1/(2 pi sqrt(Suu)); the border is 0.1/3 away.
    EXPECT_LT(1 / (2 * M_PI * std::sqrt(with(2, 2))), 0.5 * 0.1 / 3);
    EXPECT_GT(1 / (2 * M_PI * std::sqrt(without(2, 2))), 0.1 / 3);
}

TEST(LampInView, BordersPointToTheNearestSide) {
    const Sym2 b = rectangle_border(2.0, 4.0, -0.75, 1.0, 1e-3);
    EXPECT_DOUBLE_EQ(b.xx, edge_variance(0.25));
    EXPECT_DOUBLE_EQ(b.yy, edge_variance(1.0));
    const Sym2 d = disc_border(1.0, 0.0, -0.8, 1e-3);
    EXPECT_NEAR(d.yy, edge_variance(0.2), 1e-9);
    EXPECT_NEAR(d.xx, 0, 1e-9);
    EXPECT_DOUBLE_EQ(trace(disc_border(1.0, 0.0, 0.0, 1e-3)), edge_variance(1.0));
    EXPECT_DOUBLE_EQ(disc_border(1.0, 1.0, 0.0, 1e-3).xx, edge_variance(1e-3));
}

TEST(Vectors, HaveTheOperatorsOfOtherLibraries) {
    constexpr Vec3 a{1, 2, 3}, b{-2, 0, 4};
    static_assert(a * 2 == 2 * a && a / 2 == Vec3{0.5, 1, 1.5});
    Vec3 c = a;
    c += b, c -= Vec3{1, 1, 1}, c *= 3, c /= 2;
    EXPECT_EQ(c, (1.5 * Vec3{-2, 1, 6}));
    EXPECT_NEAR(length(normalize(c)), 1, 1e-15);
    EXPECT_NEAR(dot(cross(a, b), a), 0, 1e-15);
}

}  // namespace
}  // namespace support
