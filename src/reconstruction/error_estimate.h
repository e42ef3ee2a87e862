/// How far the delivered image is from the truth.
#pragma once

#include <span>

#include "reconstruction/selector.h"

namespace covtrace {

/// Estimated squared error of `image` times g, mean of the channels. The image is the mean of the
/// mixed halves and what was added to it to keep the energy.
///
/// What a pixel's halves measure of it is no estimate: raw pixels are ten times as noisy as the
/// image, and the halves that judge have chosen shares and weights before (docs/decisions/0041).
/// So it is told from what is known with little noise, averages over Gaussians of 3 pixels of
///     N = g (M_A - M_B)^2 / 4, the noise that the mixtures M of the halves do not share,
///     V = g (A - B)^2 / 4, that of the raw pixels,
///     S = g sum over c of share_c (m_c - m)^2, how far the candidates c are from their mixture,
///     E = g (image - m)^2, what light of the neighbourhood was added: all the error there is where
///     nothing is noisy,
/// as (a + a' / sqrt n) N + b V + c S + E, n the samples per pixel. The constants are those that
/// fit the true errors of a set of scenes best; `bench/error_calibration` measures how well.
Plane estimate_error(const Halves& halves, std::span<const Candidate> candidates,
                     const Selection& selection, const ColorPlanes& image, const ColorPlanes& g);

}  // namespace covtrace
