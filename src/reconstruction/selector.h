/// Which mixture of the candidates each pixel gets, by the errors that the halves show.
#pragma once

#include <span>
#include <vector>

#include "reconstruction/half_buffer.h"

namespace covtrace {

/// One way to reconstruct: each half by itself, from the samples of that half.
using Candidate = std::array<ColorPlanes, 2>;

struct Selection {
    ColorPlanes color;
    Plane error;  ///< estimated mean squared error of `color`, mean of the three channels
    std::vector<Plane> share;  ///< of each candidate
};

/// Mixes the candidates with the weights w >= 0, sum w = 1, that minimise around each pixel the
/// estimated squared error of the mixture
///     w^T G w,   G_cd = mean over the neighbourhood of g(q) { [ (F_A^c - B)(F_A^d - B) +
///                (F_B^c - A)(F_B^d - A) ] / 2 - (F_A^c - F_B^c)(F_A^d - F_B^d) / 4 }
/// A and B the raw halves, F_A^c the candidate made from A. B's own noise adds the same to every
/// entry and so to every mixture: it cancels. The last term brings the error of filters of half of
/// the samples to that of the mean of both. One normaliser g = 1 / (I^2 + eps) for all candidates:
/// one of its own for each would reward those that spread highlights.
///
/// `brightness`: I, the same scale as the colours; `sigma`: of the Gaussian neighbourhood, pixels.
Selection select(const Halves& halves, std::span<const Candidate> candidates,
                 const Plane& brightness, float sigma, bool mix);

}  // namespace covtrace
