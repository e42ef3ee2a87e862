/// The film of `--method hybrid`: two halves of the samples.
#pragma once

#include <span>

#include "reconstruction/half_buffer.h"
#include "render/film.h"

namespace covtrace {

/// Joins both halves to one film: counts are added up; means and variances are those of the mean of
/// the two halves, whatever their counts. Cross-driven counts make the halves unequal, and a mean
/// by count would favour the half that happened to be dark.
Film merged(std::span<const Film> halves);

/// The seed that the samples of both halves use in a render with `seed`.
uint64_t hybrid_seed(uint64_t seed);

/// Index of sample `index` of a half (0 or 1) in the sequence of its pixel. The halves take blocks
/// of 2, 2, 4, 8 ... samples of one sequence in turn, so that both together are as evenly spread as
/// the samples of `uniform` wherever they have 2^k samples each. The points of each half are
/// uniform, but not independent of the other one's: where one has samples, the other has gaps
/// (docs/decisions/0085). The second half takes its blocks from their ends, so that the two are far
/// apart at other counts, too.
uint32_t place_in_sequence(uint32_t half, uint32_t index);

/// Samples of a half's first block in the sequence of a pixel.
inline constexpr uint32_t kFirstBlock = 2;

/// The halves as the reconstruction reads them. Pixels that the first one alone has, as with one or
/// two samples per pixel, are dealt to both in turn, like a checkerboard. Where no pixel of a half
/// has two samples, the variances come from the difference of the halves.
Halves halves_of(std::span<const Film> halves);

}  // namespace covtrace
