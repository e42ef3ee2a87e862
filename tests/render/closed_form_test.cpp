// The closed form of Belcour 2012 for filters in real renders: a textured plane under a constant
// sky, out of focus or moving.
//
//   (4 pi^2 spectrum)^-1 = (4 pi^2 Sigma_texture)^-1 + r^2/4 I + v v^T/12
//
// The radius r of the blur disc is in pixels, the motion v in pixels per shutter. Sigma_texture, in
// pixels, is the covariance that a pinhole sees at rest. No constant is fitted.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/rng.h"
#include "covariance/covariance.hpp"
#include "tests/render/fixtures.h"

namespace covtrace {
namespace {

using namespace test;
using Sym2 = covariance::Sym2<double>;

constexpr int kSize = 64;
constexpr double kDistance = 4, kFov = 40;

/// Writes a texture of random waves with frequencies about (fx, fy) cycles per texture: nearly the
/// same spectrum everywhere.
std::filesystem::path write_waves() {
    const auto folder = std::filesystem::path(testing::TempDir());
    constexpr int n = 512;
    Image image;
    image.data = image.display = {0, 0, n, n};
    Rng rng(5);
    struct Wave {
        float kx, ky, phase;
    };
    std::vector<Wave> waves;
    for (int i = 0; i < 64; ++i) {
        const float angle = 2 * kPi * rng.next_float(), radius = 24 + 8 * rng.next_float();
        waves.push_back({std::round(radius * std::cos(angle)), std::round(radius * std::sin(angle)),
                         2 * kPi * rng.next_float()});
    }
    std::vector<float> values(size_t(n) * n);
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            float sum = 0;
            for (const Wave& w : waves)
                sum += std::cos(2 * kPi * (w.kx * float(x) + w.ky * float(y)) / n + w.phase);
            values[size_t(y) * n + size_t(x)] = 0.5f + 0.02f * sum;
        }
    for (const char* name : {"R", "G", "B"}) image.add_channel(name).values = values;
    write_exr(image, folder / "waves.exr");
    return folder;
}

Image render_plane(double lens_radius, double focus, double vx, double vy) {
    static const std::filesystem::path folder = write_waves();
    const std::string text = fmt::format(R"(
Integrator "path" "integer maxdepth" 1
Film "rgb" "integer xresolution" {0} "integer yresolution" {0}
LookAt 0 0 -{1}  0 0 0  0 1 0
Camera "perspective" "float fov" {2} "float lensradius" {3} "float focaldistance" {4}
WorldBegin
LightSource "infinite" "rgb L" [ 1 1 1 ]
Texture "waves" "spectrum" "imagemap" "string filename" "waves.exr"
Material "diffuse" "texture reflectance" "waves"
AttributeBegin
ActiveTransform EndTime
Translate {5} {6} 0
ActiveTransform All
Shape "trianglemesh" "point3 P" [ -6 -6 0  6 -6 0  6 6 0  -6 6 0 ] "point2 uv" [ 0 0 1 0 1 1 0 1 ] "integer indices" [ 0 2 1 0 3 2 ]
AttributeEnd)",
                                         kSize, kDistance, kFov, lens_radius, focus, vx, vy);
    RenderOptions options = covariance_method(32, 1);
    options.cov_spp = 32;
    return render_text(text, options, folder).image;
}

Sym2 mean_of(const Image& image, const std::array<const char*, 3>& channels) {
    return {middle_mean(image, channels[0]), middle_mean(image, channels[1]),
            middle_mean(image, channels[2])};
}
Sym2 spectrum_at(const Image& image, const std::array<const char*, 3>& channels, size_t i) {
    return {image.find(channels[0])->values[i], image.find(channels[1])->values[i],
            image.find(channels[2])->values[i]};
}
constexpr std::array<const char*, 3> kSpectrum{"spectrum.xx", "spectrum.xy", "spectrum.yy"};
/// Channels of the texture alone, in pixels, as a pinhole would see it at one instant of the same
/// light.
constexpr std::array<const char*, 3> kTexture{"cov.00", "cov.01", "cov.11"};

double pixels_per_slope() {
    return kSize / (2 * std::tan(kFov * 3.14159265358979 / 360));
}

Sym2 blurred(const Sym2& texture, const Sym2& blur) {
    const double four_pi_sq = covariance::four_pi_sq<double>;
    return (1 / four_pi_sq) * covariance::inverse(covariance::inverse(four_pi_sq * texture) + blur);
}

void expect_near(const Sym2& measured, const Sym2& expected, double tolerance) {
    EXPECT_NEAR(measured.xx / expected.xx, 1, tolerance);
    EXPECT_NEAR(measured.yy / expected.yy, 1, tolerance);
    EXPECT_NEAR(measured.xy, expected.xy, tolerance * std::sqrt(expected.xx * expected.yy));
}

/// Asserts the closed form in every pixel of the middle, with the texture that this pixel met on
/// its paths (the plane is not quite perpendicular to rays off the axis: 3 %). That texture's mean
/// is the pinhole's at rest but for how much the waves differ between the places that are seen (20
/// %).
void expect_closed_form(const Image& image, const Image& at_rest, const Sym2& blur) {
    expect_near(mean_of(image, kTexture), mean_of(at_rest, kSpectrum), 0.2);
    for (int y = kSize / 4; y < 3 * kSize / 4; y += 5)
        for (int x = kSize / 4; x < 3 * kSize / 4; x += 5) {
            const size_t i = size_t(y) * kSize + size_t(x);
            expect_near(spectrum_at(image, kSpectrum, i),
                        blurred(spectrum_at(image, kTexture, i), blur), 0.03);
        }
}

/// Asserts the mean, with the texture that a pinhole at rest sees. The closed form is concave in
/// the texture, and a blurred pixel sees a mean over several pinhole pixels: its spectrum lies
/// between the mean of their closed forms and the closed form of their mean (Jensen). 5 % beside
/// that.
void expect_mean_of_closed_form(const Image& image, const Image& at_rest, const Sym2& blur) {
    Sym2 least{};
    double n = 0;
    for (int y = kSize / 4; y < 3 * kSize / 4; ++y)
        for (int x = kSize / 4; x < 3 * kSize / 4; ++x, ++n)
            least = least +
                    blurred(spectrum_at(at_rest, kSpectrum, size_t(y) * kSize + size_t(x)), blur);
    least = (1 / n) * least;
    const Sym2 most = blurred(mean_of(at_rest, kSpectrum), blur), mean = mean_of(image, kSpectrum);
    EXPECT_GT(mean.xx, 0.95 * least.xx);
    EXPECT_GT(mean.yy, 0.95 * least.yy);
    EXPECT_LT(mean.xx, 1.05 * most.xx);
    EXPECT_LT(mean.yy, 1.05 * most.yy);
    EXPECT_NEAR(mean.xy, most.xy, 0.05 * std::sqrt(most.xx * most.yy));
}

const Image& plane_at_rest() {
    static const Image image = render_plane(0, kDistance, 0, 0);
    return image;
}

TEST(ClosedForm, PinholeAtRestSeesTheTexture) {
    const Sym2 texture = mean_of(plane_at_rest(), kSpectrum);
    // Waves of 24 to 32 cycles over 12 units: 2 to 2.7 cycles per unit, a ring in frequency whose
    // covariance is half of its squared radius. The analysis of images may say up to twice that of
    // a wave: it can't tell a wave from noise of the same gradient.
    const double per_pixel = 2.34 * kDistance / pixels_per_slope();
    const double ring = 0.5 * per_pixel * per_pixel;
    EXPECT_GT(texture.xx, ring);
    EXPECT_LT(texture.xx, 2.5 * ring);
    EXPECT_NEAR(texture.xx / texture.yy, 1, 0.1);
}

TEST(ClosedForm, DefocusedTexture) {
    for (const auto& [lens, focus] : {std::pair{0.05, 3.0}, {0.15, 3.0}, {0.3, 2.5}, {0.2, 8.0}}) {
        const double r = lens * std::abs(1 / kDistance - 1 / focus) * pixels_per_slope();
        SCOPED_TRACE(fmt::format("blur radius {} pixels", r));
        const Image image = render_plane(lens, focus, 0, 0);
        const Sym2 disc = Sym2::diagonal(r * r / 4, r * r / 4);
        expect_closed_form(image, plane_at_rest(), disc);
        expect_mean_of_closed_form(image, plane_at_rest(), disc);
    }
}

TEST(ClosedForm, MovingTexture) {
    for (const auto& [vx, vy] : {std::pair{0.3, 0.0}, {0.0, 0.8}, {0.5, -0.7}}) {
        const double to_pixels = pixels_per_slope() / kDistance;
        // World x is pixel x, seen from -z with y up; pixel y points down.
        const Sym2 blur = (to_pixels * to_pixels / 12) * Sym2{vx * vx, -vx * vy, vy * vy};
        SCOPED_TRACE(fmt::format("velocity {} {}", vx, vy));
        expect_closed_form(render_plane(0, kDistance, vx, vy), plane_at_rest(), blur);
    }
}

TEST(ClosedForm, DefocusAndMotionTogether) {
    const double r = 0.1 * std::abs(1 / kDistance - 1 / 2.8) * pixels_per_slope();
    const double v = 0.4 * pixels_per_slope() / kDistance;
    expect_closed_form(render_plane(0.1, 2.8, 0.4, 0), plane_at_rest(),
                       {r * r / 4 + v * v / 12, 0, r * r / 4});
}

}  // namespace
}  // namespace covtrace
