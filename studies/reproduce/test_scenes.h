/// Scenes with one cause of blur each, whose filters have a closed form.
#pragma once

#include <array>
#include <string>

namespace covtrace::reproduce {

/// A checkerboard that recedes from the camera, under an even sky, seen through a lens focused on
/// the middle of the image. Metres.
struct LensBoard {
    double lens_radius = 0;
    // Degrees, degrees, metres above the board.
    static constexpr double kFov = 30, kPitch = 25, kHeight = 1;
    std::string text(std::array<int, 2> resolution) const;
    /// Radius of the circle of confusion, pixels, in the middle of pixel row y.
    double blur(int y, int image_height) const;
};

/// A checkerboard parallel to the film that moves while the shutter is open, seen by a pinhole.
struct MovingBoard {
    /// Way of the board, as shares of the image's height, x to the right and y down.
    std::array<double, 2> path{0, 0};
    static constexpr double kFov = 30, kDistance = 2;
    std::string text(std::array<int, 2> resolution) const;
};

/// A board with a smooth pattern, parallel to the film, that moves to the right before, while and
/// after the shutter is open, seen by a pinhole. The pattern's amplitudes are a Gaussian of its
/// frequencies.
struct MovingPattern {
    /// Way in one shutter interval, as share of the image's height; intervals before and after.
    static constexpr double kWay = 0.12, kAround = 1;
    static constexpr double kFov = 30, kDistance = 2;
    /// Deviation of the amplitudes along each axis, periods in a tile of kTile metres.
    static constexpr double kBandwidth = 5, kTile = 1;
    static constexpr const char* kFile = "pattern.pgm";
    /// The scene's text, which names the pattern's file beside it.
    static std::string text(std::array<int, 2> resolution);
    /// The bytes of the pattern's file.
    static std::string pattern();
    /// The deviation of the amplitudes in the image, cycles per pixel.
    static double bandwidth(int image_height);
};

/// Spheres in two rows under a square light: metal with one lobe, above a diffuse base with a coat;
/// their sharpness rises from left to right.
struct SphereRows {
    static constexpr std::array<double, 5> kExponents{16, 64, 256, 1024, 4096};
    static constexpr double kRadius = 0.45, kStep = 1, kRowStep = 1.05, kDistance = 10,
                            kHalfHeight = 1.12;
    /// The roughness of GGX whose reflected lobe has the covariance of Phong's cos^e: e = 1/alpha²
    /// (C = e/(4 pi²) for Phong, brdf.hpp; a GGX lobe's C is 1/alpha² in the same unit).
    static double roughness(double exponent);
    std::string text(std::array<int, 2> resolution) const;
    /// Middle and radius of a sphere in pixels; row 0 is the metal.
    std::array<double, 3> circle(int row, int column, std::array<int, 2> resolution) const;
};

}  // namespace covtrace::reproduce
