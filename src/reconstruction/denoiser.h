/// The interface to a denoiser that somebody else wrote, as the reconstruction sees it.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "reconstruction/half_buffer.h"

namespace covtrace {

/// Features of the surfaces that a denoiser is told of: albedo in [0, 1], normals in [-1, 1], with
/// the noise of lens and shutter. A feature that is 0 everywhere is not known.
struct NoisyFeatures {
    std::array<Plane, 3> albedo, normal;
    /// Whether the features are freed of their noise in about a third of the time, and a little
    /// less well.
    bool draft = false;
};

struct NoisyImage {
    ColorPlanes color;  ///< linear, without an upper limit
    /// Whether the denoiser sees the image upside down; its result is turned back. A network errs
    /// in another way then, and the mean of both results errs less than either
    /// (docs/decisions/0085).
    bool turned = false;
    /// Whether it is denoised in about a quarter of the time, to judge by and not to look at.
    bool draft = false;
};

class Denoiser {
  public:
    virtual ~Denoiser() = default;
    /// Name of the denoiser, with its version.
    virtual std::string name() const = 0;
    /// Bytes that the denoiser holds at once for images of so many pixels, beside its arguments and
    /// results.
    virtual size_t memory(size_t pixels) const = 0;
    /// Denoises `images`, which show what `features` tell of, one by one; all planes have the same
    /// size. The result depends on nothing else, and on no number of threads. Throws Error(limit)
    /// where the denoiser fails.
    virtual std::vector<ColorPlanes> denoise(const NoisyFeatures& features,
                                             std::vector<NoisyImage> images) const = 0;
};

}  // namespace covtrace
