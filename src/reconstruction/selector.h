/// Selection: the mixture of the candidates that each pixel gets, by the errors that the halves
/// show.
#pragma once

#include <span>
#include <vector>

#include "reconstruction/candidates.h"
#include "reconstruction/likeness.h"

namespace covtrace {

/// Weights g = 1 / (I^2 + eps) of squared errors, per channel; 0 where neither half has samples,
/// and everywhere if one of them has none at all. A hole of one half judges with the pixels that
/// fill it: judged at the other half's holes alone, candidates that keep the noise of their own
/// sample would seem clean (docs/decisions/0094). `brightness` is I, on the scale of the colours.
ColorPlanes error_weights(const Halves& halves, const ColorPlanes& brightness);

struct Selection {
    std::array<ColorPlanes, 2> half;  ///< the mixture of each half; the image is their mean
    std::vector<Plane> share;         ///< share of each candidate
    std::vector<Plane> around{};      ///< sums of other planes, where they were asked for
};

/// Mixes the candidates with the weights w >= 0, sum w = 1, that minimise around each pixel the
/// squared error of the mixture that the other half shows:
///     w^T G w,   G_cd = mean over the neighbourhood and the channels of g(q) [ (F_A^c - B)(F_A^d -
///                B) + (F_B^c - A)(F_B^d - A) ] / 2
/// A and B are the raw halves, F_A^c the candidate made from A. The noise of the half that judges
/// adds the same to every entry and so to every mixture: it cancels, and no model of it is needed.
/// All candidates have one normaliser g: one for each would reward those that spread highlights.
///
/// `g` is that of `error_weights`, `sigma` the deviation of the Gaussian neighbourhood, pixels;
/// every fourth pixel is judged, the others have means of their mixtures. The last candidate is
/// taken where nothing judges. Without `mix` the best single candidate is taken.
Selection select(const Halves& halves, std::span<const Candidate> candidates, const ColorPlanes& g,
                 float sigma, bool mix = true);

/// Mixes the candidates by the errors of the pixels around that are alike: pixels that are out of
/// focus, dark or clean are not judged by sharp, bright or noisy ones beside them. Where the guides
/// say that pixels hardly differ only some are judged, and mixtures in between are means of theirs.
/// `also`: planes that are summed by the way over the pixels that judge, into `around`.
Selection select(const Halves& halves, std::span<const Candidate> candidates, const ColorPlanes& g,
                 const Likeness& likeness, bool mix = true, std::span<const Plane> also = {});

}  // namespace covtrace
