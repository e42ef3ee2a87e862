/// Agreement: what two plans that were made from different samples know of the best counts.
#pragma once

#include <array>

#include "core/plane.h"

namespace covtrace {

/// Keeps of two densities of the same pixels, made from different samples, what both agree on.
///
/// The loss by counts that are not the best ones is, to second order, the squared difference of the
/// roots of the densities. So the roots are split into bands, differences of ever wider Gaussian
/// means, and each band is shrunk as by a Wiener filter to where that loss is least: by r, the
/// correlation of both densities' bands, which is the part of a band's variance that is no noise of
/// its samples. Bands of which r is not positive are left out, and none counts more than a wider
/// one, so that no root becomes negative. Where few samples know little of single pixels the
/// counts follow what they know of whole parts of the image (docs/decisions/0118).
///
/// Pre: as many pixels in both, none negative. Post: mean 1; where all were 0, each is 1.
void keep_what_agrees(std::array<Plane, 2>& density);

}  // namespace covtrace
