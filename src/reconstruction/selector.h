/// Which mixture of the candidates each pixel gets, by the errors that the halves show.
#pragma once

#include <span>
#include <vector>

#include "reconstruction/half_buffer.h"

namespace covtrace {

/// One way to reconstruct: each half by itself, from the samples of that half.
using Candidate = std::array<ColorPlanes, 2>;

struct Selection {
    std::array<ColorPlanes, 2> half;  ///< the mixture of each half; the image is their mean
    /// Estimated squared error of the mean of the halves over I^2 + eps, mean of the channels.
    Plane error;
    std::vector<Plane> share;  ///< of each candidate
};

/// Mixes the candidates with the weights w >= 0, sum w = 1, that minimise around each pixel the
/// squared error of the mixture that the other half shows:
///     w^T G w,   G_cd = mean over the neighbourhood of g(q) [ (F_A^c - B)(F_A^d - B) +
///                (F_B^c - A)(F_B^d - A) ] / 2
/// A and B the raw halves, F_A^c the candidate made from A. The noise of the half that judges adds
/// the same to every entry and so to every mixture: it cancels, and no model of it is needed. One
/// normaliser g = 1 / (I^2 + eps) for all candidates: one of its own for each would reward those
/// that spread highlights.
///
/// The error of the mean of both halves, without the judges' noise, is
///     [ (M_A - B)^2 + (M_B - A)^2 - (A - B)^2 ] / 2 - (M_A - M_B)^2 / 4
/// in the mean over a neighbourhood, M the mixtures; never below its last term, the part of it that
/// is noise.
///
/// `brightness`: I, the same scale as the colours. `sigma`: of the Gaussian neighbourhood, pixels.
/// The last candidate is taken where nothing judges. Without `mix`: the best single one.
Selection select(const Halves& halves, std::span<const Candidate> candidates,
                 const Plane& brightness, float sigma, bool mix = true);

/// eps of relMSE: the errors of pixels darker than a tenth count as they are.
constexpr float kDarkSquared = 0.01f;

}  // namespace covtrace
