#include "reconstruction/unfiltered_share.h"

#include <algorithm>
#include <cmath>

#include "core/vec.h"
#include "reconstruction/luminance.h"

namespace covtrace {

namespace {

/// Deviation in pixels of the Gaussian over which squared differences and variances are averaged:
/// docs/decisions/0097 has the sweep.
constexpr float kNeighbourhood = 2;

/// The weight of a pixel in its own Gaussian mean: of a wide filter 1 / (2 pi sqrt |S|), of a
/// narrow one 1.
float own_weight(const covariance::Sym2<float>& s) {
    const float area = 2 * kPi * std::sqrt(std::max(0.0f, s.xx * s.yy - s.xy * s.xy));
    return 1 / std::sqrt(1 + area * area);
}

}  // namespace

Plane unfiltered_share(const FilteredLuminance& image) {
    const int w = image.raw.width, h = image.raw.height;
    Plane difference(w, h), raw(w, h), gathered(w, h), common(w, h);
    for (size_t i = 0; i < raw.size(); ++i) {
        const float relative = 1 / (sqr(image.gathered[i]) + kDarkSquared);
        const float d = relative * sqr(image.gathered[i] - image.raw[i]),
                    r = relative * image.raw_variance[i], g = relative * image.gathered_variance[i];
        // Light beyond what squares can hold says nothing, and must not spread.
        if (!std::isfinite(d) || !std::isfinite(r) || !std::isfinite(g)) continue;
        difference[i] = d;
        raw[i] = r;
        gathered[i] = g;
        common[i] = own_weight(image.filter[i]) * r;
    }
    for (Plane* plane : {&difference, &raw, &gathered, &common})
        *plane = gaussian_blur(*plane, kNeighbourhood);
    // With a bias b of the filter, variances r and g and the covariance c of both images, the
    // mixture (1 - a) gathered + a raw has the least error at a = (b^2 + g - c) / (b^2 + r + g - 2
    // c).
    Plane share(w, h);
    for (size_t i = 0; i < share.size(); ++i) {
        const float c = std::min(common[i], std::min(raw[i], gathered[i]));
        const float of_difference = raw[i] + gathered[i] - 2 * c;
        const float bias = std::max(0.0f, difference[i] - of_difference);
        const float all = bias + of_difference;
        share[i] = all > 0 ? std::clamp((bias + gathered[i] - c) / all, 0.0f, 1.0f) : 0.0f;
    }
    return share;
}

}  // namespace covtrace
