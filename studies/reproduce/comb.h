/// Combs of samples, the replicas that they make of a spectrum, and the filter that takes them
/// away.
#pragma once

#include "covariance/covariance.hpp"
#include "reproduce/grid_spectrum.h"

namespace covtrace::reproduce {

/// A comb whose teeth are whole pixels apart.
struct Comb {
    std::array<int, 2> spacing;       ///< along x and y, pixels
    std::array<int, 2> beside{0, 0};  ///< a tooth's place beside the middle of the grid, pixels
};

/// The comb with about `rate` samples per deviation of a spectrum along each axis: 1/(rate sigma)
/// apart, but at least a pixel. S in (cycles per pixel)².
Comb comb_for(const covariance::Sym2<double>& s, double rate);

/// The signal times the comb: 0 where no sample is, and each sample the weight of the pixels that
/// it stands for.
Grid sampled(const Grid& signal, const Comb& comb);

/// A grid through the Gaussian that has the covariance S of amplitudes, h(p) = 2 pi √|S|
/// exp(-2 pi² p' S p): even light stays as it is.
Grid filtered(const Grid& grid, const covariance::Sym2<double>& s);

/// The middles of the nearest replicas of the spectrum, cycles per pixel: three teeth on each side
/// of each axis, without the spectrum's own.
std::vector<std::array<double, 2>> replicas_of(const Comb& comb);

/// The energy that the replicas of a spectrum with Gaussian amplitudes of covariance S leave behind
/// the filter with the same covariance, over what the spectrum itself leaves: the sum of
/// exp(-½ k' S^-1 k) over the replicas' middles k.
double predicted_alias(const Comb& comb, const covariance::Sym2<double>& s);

/// The same, measured: the energy by which the samples of a signal differ behind the filter from
/// all its pixels, over that of these. It is the mean over places of the comb, for which the
/// replicas' phases cancel.
double measured_alias(const Grid& signal, const Comb& comb, const covariance::Sym2<double>& s);

}  // namespace covtrace::reproduce
