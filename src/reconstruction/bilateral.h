/// Bilateral means: over the pixels around that a guide says are alike.
#pragma once

#include <span>

#include "core/plane.h"

namespace covtrace {

/// Replaces every plane P by
///     sum_q k(p, q) weight(q) P(q) / sum_q k(p, q) weight(q),
///     k(p, q) = exp(-|p - q|^2 / (2 sigma^2)) max(0, 1 - (guide(p) - guide(q))^2 / reach^2)^2
/// over |p - q| <= 2 sigma in x and in y: a bilateral filter [Tomasi and Manduchi 1998] with a
/// biweight for the guide, which needs no exponential and is zero for pixels `reach` apart. 0 where
/// nothing around has weight. All planes have the guide's size.
void bilateral_blur(std::span<Plane* const> planes, const Plane& weight, const Plane& guide,
                    float sigma, float reach);

}  // namespace covtrace
