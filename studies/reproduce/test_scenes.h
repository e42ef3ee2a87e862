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
