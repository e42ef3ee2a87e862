/// The share of the raw pixels in a mixture, less where a pixel is noisier than those around it.
#pragma once

#include <array>
#include <span>

#include "reconstruction/half_buffer.h"
#include "reconstruction/selector.h"

namespace covtrace {

/// Squared noise of every pixel's mean of both halves, as the sum of the channels: what the spread
/// of its samples tells, or (A - B)^2 / 4 where the halves differ by less, as they do where both
/// see the same bright detail. The variances of the halves must not be smoothed yet.
Plane pixel_noise(const Halves& halves);

/// The noise as errors are counted, relative by `g`, the weights of error_weights; and 1 for every
/// pixel that has any, 0 for holes. The sums of both over the pixels around that are alike have the
/// mean noise there as their ratio.
std::array<Plane, 2> relative_noise(const Plane& noise, const ColorPlanes& g);

/// Lowers the share of the raw pixels, the first candidate `raw`, where they are noisier than those
/// that judged it. A share a of pixels with noise n says that they hold detail, which no other
/// candidate has, of variance s = n a / (1 - a). What a pixel of noise m is worth then is
///     s / (s + m) = a / (a + (1 - a) m / n),
/// m and n relative as errors are, n the mean over the pixels around that are alike. The other
/// candidates get the rest. A pixel that seems less noisy than those around keeps the share a: few
/// samples may agree by chance. Where nothing but the raw pixels has a share it stays whole.
/// `noise`: the first plane of relative_noise; `around`: the sums of both of its planes.
void lower_share_of_noisy(const Plane& noise, std::span<const Plane> around, const Candidate& raw,
                          Selection& s);

}  // namespace covtrace
