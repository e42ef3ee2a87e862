/// A denoiser that somebody else wrote, as the reconstruction sees it.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "reconstruction/half_buffer.h"

namespace covtrace {

/// What tells a denoiser of surfaces: albedo in [0, 1], normals in [-1, 1], with the noise of lens
/// and shutter.
struct NoisyFeatures {
    std::array<Plane, 3> albedo, normal;
    /// Freed of their noise in about a third of the time, and a little less well.
    bool draft = false;
};

struct NoisyImage {
    ColorPlanes color;  ///< linear, without an upper limit
    /// The denoiser sees it upside down, and what it makes of it is turned back. A network errs in
    /// another way then, and the mean of both results errs less than either
    /// (docs/decisions/0085).
    bool turned = false;
    /// In about a third of the time, to judge by and not to look at.
    bool draft = false;
};

class Denoiser {
  public:
    virtual ~Denoiser() = default;
    /// With its version.
    virtual std::string name() const = 0;
    /// Bytes that it has at once for images of so many pixels, beside what it gets and gives.
    virtual size_t memory(size_t pixels) const = 0;
    /// `images` of what `features` tell of, denoised one by one; all planes have the same size.
    /// Depends on nothing else, and on no number of threads. Throws Error(limit) where it fails.
    virtual std::vector<ColorPlanes> denoise(const NoisyFeatures& features,
                                             std::vector<NoisyImage> images) const = 0;
};

}  // namespace covtrace
