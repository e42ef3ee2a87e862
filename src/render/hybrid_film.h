/// The film of `--method hybrid`: two independent halves and the covariances.
#pragma once

#include <array>

#include "planner/adaptive.h"
#include "planner/covariance_buffer.h"
#include "reconstruction/half_buffer.h"
#include "render/film.h"

namespace covtrace {

/// The samples of each half come from a scramble of their own. 248 bytes a pixel.
struct HybridFilm {
    explicit HybridFilm(PixelBounds region)
        : half{Film(region, true), Film(region, true)},
          covariance(region.width(), region.height()) {}
    std::array<Film, 2> half;
    CovarianceBuffer covariance;

    double mean_count() const { return half[0].mean_count() + half[1].mean_count(); }
    /// Both halves as one: counts and rays added up; means and variances those of the mean of the
    /// two halves, whatever their counts. Cross-driven counts make the halves unequal, and a mean
    /// by count would favour the half that happened to be dark.
    Film merged() const;
};

/// The seed of half `k` in a render with `seed`.
uint64_t half_seed(uint64_t seed, int k);

/// The halves as the reconstruction reads them. Where no pixel of a half has two samples the
/// variances come from the difference of the halves.
Halves halves_of(const HybridFilm& film);

}  // namespace covtrace
