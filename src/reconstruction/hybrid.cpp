#include "reconstruction/hybrid.h"

#include <algorithm>
#include <cmath>

#include "core/vec.h"
#include "reconstruction/guides.h"
#include "reconstruction/outliers.h"
#include "reconstruction/selector.h"

namespace covtrace {

namespace {

ColorPlanes mean_of(const Halves& halves) {
    ColorPlanes mean = halves[0].color;
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < mean[c].size(); ++i)
            mean[c][i] = 0.5f * (mean[c][i] + halves[1].color[c][i]);
    return mean;
}

/// A first guess of the brightness that errors are measured against: the mean over all candidates
/// but the raw one, the same for all channels.
ColorPlanes common_brightness(std::span<const Candidate> candidates) {
    const size_t first = candidates.size() > 1 ? 1 : 0;
    Plane sum(candidates[0][0][0].width, candidates[0][0][0].height);
    for (size_t c = first; c < candidates.size(); ++c)
        for (const ColorPlanes& half : candidates[c])
            for (const Plane& channel : half)
                for (size_t i = 0; i < sum.size(); ++i) sum[i] += channel[i];
    const float scale = 1 / float(6 * (candidates.size() - first));
    for (float& v : sum.values) v *= scale;
    return {sum, sum, sum};
}

ColorPlanes mean_of(const Selection& s) {
    ColorPlanes mean = s.half[0];
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < mean[c].size(); ++i)
            mean[c][i] = 0.5f * (mean[c][i] + s.half[1][c][i]);
    return mean;
}

}  // namespace

HybridImage reconstruct(Halves halves, std::span<const covariance::Sym2<float>> spectrum,
                        const HybridSettings& settings) {
    for (HalfBuffer& half : halves) fill_holes(half);
    const ColorPlanes all = mean_of(halves);
    limit_outliers(halves);
    // Variances that know of their own pixel's mean would let bright pixels accept dark ones and
    // not the other way round.
    for (HalfBuffer& half : halves)
        for (Plane& v : half.color_variance) v = box_blur(v, 1);
    const std::vector<Candidate> candidates =
        make_candidates(halves, spectrum, settings.candidates);
    Likeness likeness(settings.likeness);
    add_features(halves, likeness);
    for (HalfBuffer& half : halves) half.feature = half.feature_variance = {};  // large, not needed
    // Twice, as candidates that spread highlights also lift the first guess of what is dark, which
    // hides their errors there; and as the guess tells which pixels are alike.
    const ColorPlanes guess =
        mean_of(select(halves, candidates, error_weights(halves, common_brightness(candidates)),
                       settings.sigma, settings.mix));
    add_light_and_noise(halves, guess, likeness);
    Selection s = select(halves, candidates, error_weights(halves, guess), likeness, settings.mix);

    HybridImage image;
    image.color = mean_of(s);
    // A fit may leave the range of its colours: light is never negative.
    for (Plane& channel : image.color)
        for (float& v : channel.values) v = std::max(0.0f, v);
    const Plane near = return_energy(all, image.color);
    ErrorEstimate error =
        estimate_error(halves, candidates, s, image.color, all, near, guess, settings.error);
    image.share = std::move(s.share);
    image.relative_error = std::move(error.color);
    image.variance = std::move(error.luminance);
    const Plane bright = luminance(image.color);
    for (size_t i = 0; i < bright.size(); ++i) image.variance[i] *= sqr(bright[i]) + kDarkSquared;
    return image;
}

}  // namespace covtrace
