/// The film of `--method hybrid`: two halves of the samples, each from a scramble of its own.
#pragma once

#include <span>

#include "reconstruction/half_buffer.h"
#include "render/film.h"

namespace covtrace {

/// Both halves as one: counts added up; means and variances those of the mean of the two halves,
/// whatever their counts. Cross-driven counts make the halves unequal, and a mean by count would
/// favour the half that happened to be dark.
Film merged(std::span<const Film> halves);

/// The seed of half `k` in a render with `seed`.
uint64_t half_seed(uint64_t seed, int k);

/// The halves as the reconstruction reads them. Where no pixel of a half has two samples the
/// variances come from the difference of the halves.
Halves halves_of(std::span<const Film> halves);

}  // namespace covtrace
