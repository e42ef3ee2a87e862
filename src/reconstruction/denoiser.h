/// A denoiser that somebody else wrote, as the reconstruction sees it.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "reconstruction/half_buffer.h"

namespace covtrace {

/// What a denoiser gets: linear colours without an upper limit, albedo in [0, 1], normals in
/// [-1, 1], the last two with the noise of lens and shutter. All planes have the same size.
struct NoisyImage {
    ColorPlanes color;
    std::array<Plane, 3> albedo, normal;
};

class Denoiser {
  public:
    virtual ~Denoiser() = default;
    /// With its version.
    virtual std::string name() const = 0;
    /// Bytes that it has at once for images of so many pixels, beside what it gets and gives.
    virtual size_t memory(size_t pixels) const = 0;
    /// `images`, denoised one by one. Depends on nothing else, and on no number of threads. Throws
    /// Error(limit) where it fails.
    virtual std::vector<ColorPlanes> denoise(std::vector<NoisyImage> images) const = 0;
};

}  // namespace covtrace
