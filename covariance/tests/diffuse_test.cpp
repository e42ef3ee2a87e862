// Diffuse reflection of light from a near emitter, against the light that such an emitter casts.
#include "support.h"

namespace support {
namespace {

using namespace covariance;

constexpr double kFourPiSq = 4 * M_PI * M_PI;

/// A receiver in the plane z = 0 and an emitter at the unit distance, `theta` from the zenith; its
/// normal is turned by `tilt` from the direction of its light.
struct Setting {
    double theta = 0, tilt = 0;
    bool even = false;

    Surface floor{};
    Vec3 place() const { return {std::sin(theta), 0, std::cos(theta)}; }
    Vec3 normal() const {
        return even ? Vec3{} : Vec3{-std::sin(theta + tilt), 0, -std::cos(theta + tilt)};
    }
    Frame arriving() const { return frame_along<double>(-place()); }
    double irradiance(double x, double y) const {
        const Vec3 d = place() - Vec3{x, y, 0};
        const double r = length(d), cos_floor = d.z / r;
        return cos_floor * (even ? 1 : -dot(normal(), d) / r) / (r * r);
    }
};

/// Second derivative that a Gaussian window sees whose deviation is half the result's, root mean
/// square with the third one, along x or y: by quadrature and iteration.
double windowed_bandwidth(const Setting& s, bool along_x) {
    constexpr int kSteps = 40;
    double f[2] = {4, 4};
    for (int iteration = 0; iteration < 40; ++iteration) {
        const double w[2] = {0.5 / std::sqrt(f[0]), 0.5 / std::sqrt(f[1])};
        // By symmetry about the plane of incidence the coefficients xy, xxy and yyy are zero.
        double mean = 0, xx = 0, yy = 0, xxx = 0, xyy = 0;
        for (int i = 0; i < kSteps; ++i)
            for (int j = 0; j < kSteps; ++j) {
                const double a = -4 + 8 * (i + 0.5) / kSteps, b = -4 + 8 * (j + 0.5) / kSteps;
                const double g = std::exp(-(a * a + b * b) / 2) *
                                 std::max(s.irradiance(w[0] * a, w[1] * b), 0.0);
                mean += g;
                xx += g * (a * a - 1), yy += g * (b * b - 1);
                xxx += g * (a * a - 3) * a, xyy += g * (b * b - 1) * a;
            }
        const auto unsmoothed = [](double l) { return l < 0 ? l / (1 + l) : l; };
        const double square[2] = {
            std::pow(unsmoothed(xx / mean), 2) + (xxx * xxx + xyy * xyy) / (mean * mean),
            std::pow(unsmoothed(yy / mean), 2) + 2 * xyy * xyy / (mean * mean)};
        for (int k = 0; k < 2; ++k) f[k] = std::sqrt(f[k] * std::sqrt(square[k]) / (w[k] * w[k]));
    }
    return f[along_x ? 0 : 1];
}

TEST(NearEmitter, BandwidthFollowsTheExactFalloff) {
    double worst = 1;
    for (const bool even : {false, true})
        for (const double tilt : {0.0, 0.3, -0.3, 10.0})
            for (int degrees = 0; degrees <= 75; degrees += 5) {
                Setting s{degrees * M_PI / 180, tilt, even};
                if (tilt == 10.0) s.tilt = -s.theta;  // parallel to the receiver
                const Sym2 f = falloff_bandwidth(s.arriving(), s.floor, s.normal());
                EXPECT_NEAR(f.xy, 0, 1e-12);
                const double x = std::sqrt(f.xx / windowed_bandwidth(s, true));
                const double y = std::sqrt(f.yy / windowed_bandwidth(s, false));
                for (const double ratio : {x, y})
                    if (std::abs(std::log(ratio)) > std::abs(std::log(worst))) worst = ratio;
                EXPECT_LT(x, 1.18) << degrees << ", tilt " << s.tilt << ", even " << even;
                EXPECT_GT(x, 0.85) << degrees << ", tilt " << s.tilt << ", even " << even;
                EXPECT_LT(y, 1.18) << degrees << ", tilt " << s.tilt << ", even " << even;
                EXPECT_GT(y, 0.85) << degrees << ", tilt " << s.tilt << ", even " << even;
            }
    std::printf("worst ratio of bandwidths: %.3f\n", worst);
}

TEST(NearEmitter, RightBelowItTheWindowIsTheCosine) {
    const Setting s;
    const Sym2 sharp = Sym2::diagonal(1e12, 1e12);
    const Sym2 near = diffuse_window(s.arriving(), s.floor, {s.normal(), 1.0}, sharp);
    EXPECT_LT(distance(near, cosine_window(s.arriving(), s.floor.n)), 1e-9);
}

TEST(NearEmitter, ADistantOneHasTheCosineWindowAlone) {
    Setting s;
    s.theta = 1.2;
    const Sym2 sharp = Sym2::diagonal(1e12, 1e12);
    const Sym2 sky = diffuse_window(s.arriving(), s.floor, {}, sharp);
    EXPECT_LT(distance(sky, cosine_window(s.arriving(), s.floor.n)), 1e-9);
    // A strongly curved receiver hardly notices the parallax of a near one.
    Surface ball = s.floor;
    ball.curvature = {1e4, 0, 1e4};
    EXPECT_LT(distance(diffuse_window(s.arriving(), ball, {s.normal(), 1.0}, sharp), sky), 1e-6);
}

RC_GTEST_PROP(NearEmitter, DoesNotDependOnTheFrames, ()) {
    const Vec3 z = draw_direction();
    const Surface floor = draw_surface(z);
    const Vec3 normal = draw_leaving(z);
    const Field light{draw_psd(), draw_frame(z)};
    Surface turned = floor;
    const double a = draw(0, 6), c = std::cos(a), d = std::sin(a);
    turned.t1 = c * floor.t1 + d * floor.t2, turned.t2 = c * floor.t2 - d * floor.t1;
    const Sym2& k = floor.curvature;
    turned.curvature = congruence(k, Mat2{c, -d, d, c});
    const auto reflected = [&](const Surface& s, const Field& f) {
        const Field left =
            reflect_diffuse(surface_enter(f, s), s, floor.n, {normal, static_cast<double>(2)});
        return surface_exit(left, s).sigma;
    };
    const Field other = rotate_to(light, draw_frame_like(light.frame));
    RC_ASSERT(distance(reflected(floor, light), reflected(turned, other), largest(light.sigma)) <
              1e-7);
}

RC_GTEST_PROP(NearEmitter, IsPositiveSemiDefiniteWithoutAngles, ()) {
    const Vec3 z = draw_direction();
    const Surface floor = draw_surface(z);
    const Field light{draw_psd(), draw_frame(z)};
    const Field left = reflect_diffuse(surface_enter(light, floor), floor, floor.n,
                                       {draw_direction(), draw(0.1, 10)});
    RC_ASSERT(is_psd(left.sigma, largest(light.sigma)));
    for (const std::size_t i : {axis::u, axis::v})
        for (std::size_t j = 0; j < 5; ++j) RC_ASSERT(left.sigma(i, j) == 0);
}

/// The curvature -Hess/value, at its centre, of the lobe (1 + r^2)^-2 blurred by a Gaussian light
/// of variance s2.
double blurred_lobe(double s2) {
    double value = 0, second = 0;
    constexpr int kSteps = 4000;
    for (int i = 0; i < kSteps; ++i) {
        const double r = 9 * std::sqrt(s2) * (i + 0.5) / kSteps;
        const double w = r * std::exp(-r * r / (2 * s2)) / ((1 + r * r) * (1 + r * r));
        value += w;
        second += w * (r * r / (2 * s2) - 1) / s2;
    }
    return -second / value;
}

TEST(TailedLobe, FollowsALightOfAnySize) {
    const Sym2 lobe = Sym2::diagonal(4 / kFourPiSq, 4 / kFourPiSq);
    for (const double s2 : {0.01, 0.03, 0.0625, 0.125, 0.25, 0.5, 1.0, 2.0}) {
        const double light = 1 / (kFourPiSq * s2);
        const double c = tailed_lobe(lobe, Sym2::diagonal(light, light)).xx;
        // In a convolution inverses add.
        const double ratio = std::sqrt(1 / (1 / c + 1 / light) * kFourPiSq / blurred_lobe(s2));
        EXPECT_GT(ratio, 0.98) << s2;
        EXPECT_LT(ratio, s2 <= 0.25 ? 1.02 : 1.06) << s2;
    }
}

}  // namespace
}  // namespace support
