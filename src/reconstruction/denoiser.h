/// The interface to a denoiser that somebody else wrote, as the reconstruction sees it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/enum_names.h"
#include "reconstruction/half_buffer.h"

namespace covtrace {

/// The part that a denoiser has in an image.
enum class DenoiserQuality : uint8_t {
    high,  ///< the best that it can, mixed with our own candidates
    fast,  ///< the whole image, in a sixth of the time (docs/decisions/0147)
};

template <>
inline constexpr auto kEnumNames<DenoiserQuality> =
    enum_names<DenoiserQuality>({{DenoiserQuality::high, "high"}, {DenoiserQuality::fast, "fast"}});

/// How features are freed of their noise before they guide a denoiser.
enum class FeatureCleaning : uint8_t {
    thorough,
    draft,  ///< in about a third of the time, and a little less well
    none,   ///< not at all: the denoiser takes them as they are, and itself a third of its time
};

/// Features of the surfaces that a denoiser is told of: albedo in [0, 1], normals in [-1, 1], with
/// the noise of lens and shutter. A feature that is 0 everywhere is not known.
struct NoisyFeatures {
    std::array<Plane, 3> albedo, normal;
    FeatureCleaning cleaning = FeatureCleaning::thorough;
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
