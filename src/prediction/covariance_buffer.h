/// Covariance buffers: a 5x5 covariance and its weight per pixel, and the prediction from them.
#pragma once

#include <span>
#include <vector>

#include "covariance/covariance_image.hpp"
#include "prediction/packed_covariance.h"

namespace covtrace {

using Covariance5 = covariance::SymmetricMatrix5<float>;
using Covariance2 = covariance::Sym2<float>;

/// Types of the covariance library: radiance-weighted mean covariances of the pixels, and the
/// prediction that follows from them.
using CovarianceBuffer = covariance::CovarianceImage<float>;
using Prediction = covariance::Prediction<float>;

/// The covariances of a pixel's light, in two parts, row by row. `in_view` is the light of emitters
/// that are seen directly or by specular lobes that were each more likely than not
/// (PathVertex::in_view), `scattered` is all other light. An emitter in view outshines the light
/// beside it a hundred times: in one mean it would decide the spectra around it, and the tails of
/// filters would carry it over its border.
struct CovarianceBuffers {
    CovarianceBuffers(int w, int h)
        : width(w), height(h), scattered(size_t(w) * size_t(h)), in_view(scattered.size()) {}
    int width, height;
    std::vector<PackedCovariance> scattered, in_view;

    size_t memory() const {  ///< bytes
        return (scattered.size() + in_view.size()) * sizeof(PackedCovariance);
    }
};
/// The covariances and weights of width * height pixels, row by row.
CovarianceBuffer unpack(std::span<const PackedCovariance> packed, int width, int height);
/// Covariances of all light: the mean of both parts, weighted by their radiance.
CovarianceBuffer merge(const CovarianceBuffers& buffers);
/// Covariances of all light as `merge` has them, packed for a film: from double precision, without
/// the rounding to floats that `merge` ends with.
std::vector<PackedCovariance> packed_merge(const CovarianceBuffers& buffers);

/// Predicts every pixel by its own covariance, without smoothing, in parallel
/// (covariance::preintegrate): the `spectrum` layer.
Prediction preintegrated(const CovarianceBuffer& buffer);

/// Smooths in parallel (covariance::smooth): means over 3x3 pixels, holes filled from the nearest
/// pixel.
CovarianceBuffer smoothed(const CovarianceBuffer& buffer);

}  // namespace covtrace
