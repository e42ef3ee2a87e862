/// The local bandwidth of an image, as a texture or an environment map has it around a point.
#pragma once

#include <functional>
#include <memory>
#include <span>

#include "core/vec.h"
#include "texture/spatial_covariance.h"

namespace covtrace {

/// Bandwidth of an image. Around each point it is seen through Gaussian windows of all sizes w = 1,
/// 2, 4 ... texels. Each window gives an estimate
///
///     T_w = C / (2 pi^2 V) * min(1, V / (0.1 mean)^2) * min(1, w^2 trace(C) / V)
///
/// with C the covariance inside the window of the gradient (at the derivative scale 0.29 w) and V
/// the variance of the values in the window 2 w about their linear trend. The second factor leaves
/// out contrasts that the eye and the error of an image don't see, the third one windows that are
/// too small for the wavelength they report: these see a part of a slope. The estimate with the
/// largest trace counts, made to have at least a tenth of its largest variance in every direction,
/// because structures bend. At the distance d from a straight edge this is about
/// 1 / (4 pi^2 (d/2)^2) across the edge; for noise it is the covariance of its amplitude spectrum.
///
/// An image is analysed where and at the resolutions that it is asked for, in tiles: a render asks
/// for what it sees, about as fine as its pixels. Any number of threads may ask.
class ImageSpectrum {
  public:
    /// How the image continues beyond its borders; `repeat_s` repeats in s and clamps in t, as
    /// lat-long maps do, `repeat_t` the other way round.
    enum class Wrap { repeat, clamp, repeat_s, repeat_t };
    /// Largest side that is analysed as it is; larger images are averaged over squares of texels
    /// first.
    static constexpr int kMaxAnalysedSize = 2048;

    /// Makes the spectrum of a constant image: no bandwidth anywhere.
    ImageSpectrum() = default;
    /// `luminance`: width * height finite linear values, row by row from t = 0 at the first row.
    ImageSpectrum(std::span<const float> luminance, int width, int height, Wrap wrap);
    /// Analyses luminance(i), row by row. It is asked for each texel twice, so that a large image
    /// never has to be in memory as floating-point numbers.
    ImageSpectrum(const std::function<float(size_t)>& luminance, int width, int height, Wrap wrap);
    /// Covariance (amplitude spectrum) around (s, t), one unit of s and t being the whole image.
    /// Symmetric positive semi-definite and finite everywhere; outside the image, where it is
    /// clamped, that of the border.
    ///
    /// `footprint`: extent of a pixel in the same units. Structure below it is averaged by the
    /// pixel filter before anything else happens to the image, so the analysis is of the image
    /// smoothed to it (by a Gaussian of half the footprint). 0: of the image as it is.
    SpatialCovariance2 at(float s, float t, Vec2 footprint = {}) const;
    size_t memory() const;  ///< bytes; not while others look up

  private:
    class Scale;
    struct Pyramid;
    std::shared_ptr<const Pyramid> pyramid_;  ///< none: constant
};

}  // namespace covtrace
