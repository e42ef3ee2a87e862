/// One 5x5 covariance and its weight per pixel, and the prediction that follows from them.
#pragma once

#include <span>
#include <vector>

#include "covariance/covariance.hpp"
#include "planner/packed_covariance.h"

namespace covtrace {

using Covariance5 = covariance::SymmetricMatrix5<float>;
using Covariance2 = covariance::Sym2<float>;

/// Radiance-weighted mean covariances over (pixel x, pixel y, lens, lens, shutter), row by row.
/// Weight 0: no path of the pixel found light, and the covariance is zero.
struct CovarianceBuffer {
    CovarianceBuffer(int w, int h)
        : width(w),
          height(h),
          covariance(size_t(w) * size_t(h)),
          weight(size_t(w) * size_t(h), 0.0f) {}
    int width, height;
    std::vector<Covariance5> covariance;
    std::vector<float> weight;
};

/// The light of a pixel in two parts. An emitter in view outshines what is beside it a hundred
/// times: in one mean it would decide the spectra around it, and the tails of filters would carry
/// it over its border. `scattered` is all the light that surfaces sent on.
struct CovarianceBuffers {
    CovarianceBuffers(int w, int h)
        : width(w), height(h), scattered(size_t(w) * size_t(h)), in_view(scattered.size()) {}
    int width, height;
    std::vector<PackedCovariance> scattered, in_view;

    size_t memory() const {  ///< bytes
        return (scattered.size() + in_view.size()) * sizeof(PackedCovariance);
    }
};
CovarianceBuffer unpack(std::span<const PackedCovariance> packed, int width, int height);
/// The covariances of all light: the mean of both parts, weighted by their radiance.
CovarianceBuffer merge(const CovarianceBuffers& buffers);
/// The same to keep; no rounding to floats comes before the packing.
std::vector<PackedCovariance> packed_merge(const CovarianceBuffers& buffers);

/// What a pixel needs, seen from its covariance after the integral over lens and shutter.
struct Prediction {
    int width = 0, height = 0;
    std::vector<Covariance2> spectrum;  ///< (cycles/pixel)^2
    /// N_int = sqrt(det(S_rr + W_rr) / det W_rr) >= 1: variation over lens and shutter.
    std::vector<float> interior_count;
};

/// Pre-integrates every pixel as it is, without smoothing: the `spectrum` layer.
Prediction preintegrate(const CovarianceBuffer& buffer);

/// The buffer averaged by weight over 3x3 pixels: the noise of few paths is larger than what the
/// mean hides. Where none of the nine has a weight, the covariance of a nearest pixel that has one.
/// Weights stay. Where no pixel at all has a weight every covariance is zero.
CovarianceBuffer smooth(const CovarianceBuffer& buffer);

}  // namespace covtrace
