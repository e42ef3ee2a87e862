#include "reproduce/test_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace covtrace::reproduce {

namespace {

double radians(double degrees) {
    return degrees * std::numbers::pi / 180;
}

/// Number of pixels per unit of slope.
double pixels_per_slope(double fov, int height) {
    return 0.5 * height / std::tan(radians(fov) / 2);
}

std::string film(const std::string& name, std::array<int, 2> r) {
    return fmt::format(
        "Film \"rgb\" \"string filename\" \"{}.exr\" \"integer xresolution\" {} \"integer "
        "yresolution\" {}\nPixelFilter \"gaussian\" \"float xradius\" 1.5 \"float yradius\" 1.5\n"
        "Sampler \"zsobol\" \"integer pixelsamples\" 16\n",
        name, r[0], r[1]);
}

/// The text of a square of half side `half` in the plane z = 0, with squares of `side`.
std::string board(double half, double side) {
    return fmt::format(
        "Texture \"squares\" \"spectrum\" \"checkerboard\" \"float uscale\" {0} \"float vscale\" "
        "{0}\n    \"rgb tex1\" [ .8 .78 .74 ] \"rgb tex2\" [ .06 .06 .08 ]\n"
        "Material \"diffuse\" \"texture reflectance\" \"squares\"\n"
        "Shape \"trianglemesh\" \"point3 P\" [ -{1} -{1} 0  {1} -{1} 0  {1} {1} 0  -{1} {1} 0 ]\n"
        "    \"point2 uv\" [ 0 0 1 0 1 1 0 1 ] \"integer indices\" [ 0 1 2 0 2 3 ]\n",
        2 * half / side, half);
}

constexpr const char* kSky = "LightSource \"infinite\" \"rgb L\" [ 1 1 1 ]\n";

/// Depth of the board along the optical axis where pixel row y sees its middle.
double depth(double y, int height) {
    const double up = (0.5 * height - y) / pixels_per_slope(LensBoard::kFov, height);
    const double pitch = radians(LensBoard::kPitch);
    return LensBoard::kHeight / (std::sin(pitch) - up * std::cos(pitch));
}

double focal_distance() {
    return LensBoard::kHeight / std::sin(radians(LensBoard::kPitch));
}

}  // namespace

std::string LensBoard::text(std::array<int, 2> resolution) const {
    const double pitch = radians(kPitch);
    return "# A checkerboard through a lens that is focused on the middle of the image; metres, z "
           "up.\n" +
           film("lens", resolution) +
           fmt::format(
               "Integrator \"path\" \"integer maxdepth\" 1\n"
               "LookAt 0 0 {}  0 {} {}  0 0 1\n"
               "Camera \"perspective\" \"float fov\" {} \"float lensradius\" {} \"float "
               "focaldistance\" {}\nWorldBegin\n{}{}",
               kHeight, std::cos(pitch), kHeight - std::sin(pitch), kFov, lens_radius,
               focal_distance(), kSky, board(24, 0.15));
}

double LensBoard::blur(int y, int image_height) const {
    // A point at the depth z meets the plane in focus within lens_radius |z - f| / z of its middle.
    const double z = depth(y + 0.5, image_height);
    return lens_radius * pixels_per_slope(kFov, image_height) *
           std::abs(1 / focal_distance() - 1 / z);
}

std::string MovingBoard::text(std::array<int, 2> resolution) const {
    const double height = 2 * kDistance * std::tan(radians(kFov) / 2);
    const double dx = 0.5 * path[0] * height, dy = -0.5 * path[1] * height;
    return "# A checkerboard that moves while the shutter is open, seen by a pinhole; metres.\n" +
           film("motion", resolution) +
           fmt::format(
               "Integrator \"path\" \"integer maxdepth\" 1\n"
               "Camera \"perspective\" \"float fov\" {} \"float shutteropen\" 0 \"float "
               "shutterclose\" 1\nWorldBegin\n{}"
               "ActiveTransform StartTime\nTranslate {} {} {}\n"
               "ActiveTransform EndTime\nTranslate {} {} {}\nActiveTransform All\n{}",
               kFov, kSky, -dx, -dy, kDistance, dx, dy, kDistance, board(6, 0.15));
}

std::string MovingPattern::text(std::array<int, 2> resolution) {
    const double height = 2 * kDistance * std::tan(radians(kFov) / 2);
    const double dx = (0.5 + kAround) * kWay * height, half = 6;
    return "# A smooth pattern that moves while the shutter is open, seen by a pinhole; metres.\n" +
           film("slice", resolution) +
           fmt::format(
               "Integrator \"path\" \"integer maxdepth\" 1\n"
               "Camera \"perspective\" \"float fov\" {} \"float shutteropen\" 0 \"float "
               "shutterclose\" 1\nTransformTimes {} {}\nWorldBegin\n{}"
               "ActiveTransform StartTime\nTranslate {} 0 {}\n"
               "ActiveTransform EndTime\nTranslate {} 0 {}\nActiveTransform All\n",
               kFov, -kAround, 1 + kAround, kSky, -dx, kDistance, dx, kDistance) +
           fmt::format(
               "Texture \"pattern\" \"spectrum\" \"imagemap\" \"string filename\" \"{}\" "
               "\"string encoding\" \"linear\"\n    \"float uscale\" {} \"float vscale\" {}\n"
               "Material \"diffuse\" \"texture reflectance\" \"pattern\"\n"
               "Shape \"trianglemesh\" \"point3 P\" [ -{} -{} 0  {} -{} 0  {} {} 0  -{} {} 0 ]\n"
               "    \"point2 uv\" [ 0 0 1 0 1 1 0 1 ] \"integer indices\" [ 0 1 2 0 2 3 ]\n",
               kFile, 2 * half / kTile, 2 * half / kTile, half, half, half, half, half, half, half,
               half);
}

std::string MovingPattern::pattern() {
    constexpr int kSide = 128, kMost = 3 * int(kBandwidth);
    constexpr double kMean = 0.45, kDeviation = 0.13;
    std::mt19937 random(1);
    std::vector<double> values(size_t(kSide) * kSide, 0);
    double energy = 0;
    for (int ky = 0; ky <= kMost; ++ky)
        for (int kx = -kMost; kx <= kMost; ++kx) {
            if (ky == 0 && kx <= 0) continue;  // the mean, and what mirrors the others
            const double amplitude =
                std::exp(-0.5 * (kx * kx + ky * ky) / (kBandwidth * kBandwidth));
            const double phase = 2 * std::numbers::pi * double(random()) / double(random.max());
            energy += 0.5 * amplitude * amplitude;
            for (int y = 0; y < kSide; ++y)
                for (int x = 0; x < kSide; ++x)
                    values[size_t(y) * kSide + size_t(x)] +=
                        amplitude *
                        std::cos(2 * std::numbers::pi * (kx * x + ky * y) / kSide + phase);
        }
    std::string bytes = fmt::format("P5\n{} {}\n255\n", kSide, kSide);
    for (const double v : values)
        bytes += char(
            std::lround(255 * std::clamp(kMean + kDeviation * v / std::sqrt(energy), 0.0, 1.0)));
    return bytes;
}

double MovingPattern::bandwidth(int image_height) {
    return kBandwidth / kTile * 2 * kDistance * std::tan(radians(kFov) / 2) / image_height;
}

double SphereRows::roughness(double exponent) {
    return 1 / std::sqrt(exponent);
}

std::string SphereRows::text(std::array<int, 2> resolution) const {
    const double fov = 2 * std::atan(kHalfHeight / kDistance) * 180 / std::numbers::pi;
    std::string s =
        "# Spheres of Phong exponents 16, 64, 256, 1024, 4096 (as GGX roughness): metal above, "
        "coated\n# diffuse below. One square light, dim sky; y up.\n" +
        film("shininess", resolution) +
        fmt::format(
            "Integrator \"path\" \"integer maxdepth\" 2\nLookAt 0 0 -{}  0 0 0  0 1 0\n"
            "Camera \"perspective\" \"float fov\" {}\nWorldBegin\n"
            "LightSource \"infinite\" \"rgb L\" [ .4 .44 .5 ]\n"
            "AttributeBegin\nAreaLightSource \"diffuse\" \"rgb L\" [ 120 114 104 ] \"bool twosided\" "
            "true\nMaterial \"diffuse\" \"rgb reflectance\" [ 0 0 0 ]\n"
            "Shape \"trianglemesh\" \"integer indices\" [ 0 1 2 0 2 3 ]\n    \"point3 P\" "
            "[ -.5 4.376 -4.381  -.5 5.024 -3.619  .5 5.024 -3.619  .5 4.376 -4.381 ]\n"
            "AttributeEnd\n",
            kDistance, fov);
    for (int row = 0; row < 2; ++row)
        for (size_t i = 0; i < kExponents.size(); ++i)
            s += fmt::format(
                "AttributeBegin\nTranslate {} {} 0\nMaterial {} \"float roughness\" {} \"bool "
                "remaproughness\" false\nShape \"sphere\" \"float radius\" {}\nAttributeEnd\n",
                kStep * (double(i) - 0.5 * double(kExponents.size() - 1)),
                row == 0 ? 0.5 * kRowStep : -0.5 * kRowStep,
                row == 0 ? "\"conductor\" \"spectrum eta\" \"metal-Al-eta\" \"spectrum k\" "
                           "\"metal-Al-k\""
                         : "\"coateddiffuse\" \"rgb reflectance\" [ .35 .08 .05 ]",
                roughness(kExponents[i]), kRadius);
    return s;
}

std::array<double, 3> SphereRows::circle(int row, int column, std::array<int, 2> r) const {
    const double pixels = 0.5 * r[1] / kHalfHeight;
    const double x = kStep * (column - 0.5 * double(kExponents.size() - 1));
    const double y = row == 0 ? 0.5 * kRowStep : -0.5 * kRowStep;
    return {0.5 * r[0] + pixels * x, 0.5 * r[1] - pixels * y, pixels * kRadius};
}

}  // namespace covtrace::reproduce
