#include "reconstruction/hybrid.h"

#include <algorithm>
#include <cmath>

#include "core/vec.h"
#include "reconstruction/feature_filter.h"
#include "reconstruction/gather.h"
#include "reconstruction/outliers.h"
#include "reconstruction/regression.h"
#include "reconstruction/selector.h"

namespace covtrace {

namespace {

/// The windows of regressions reach this many times as far as the predicted filters.
constexpr float kWindowWidening = 2.5f;

ColorPlanes gaussian(const HalfBuffer& half, const FilterField& field) {
    const size_t n = half.count.size();
    std::vector<Rgb> mean(n);
    const std::vector<float> variance(n, 0.0f);
    std::vector<uint32_t> count(n);
    for (size_t i = 0; i < n; ++i) {
        mean[i] = {half.color[0][i], half.color[1][i], half.color[2][i]};
        count[i] = half.count[i] > 0 ? 1 : 0;
    }
    const GatheredImage image = gather(mean, variance, count, field);
    ColorPlanes out;
    for (size_t c = 0; c < 3; ++c) {
        out[c] = Plane(half.count.width, half.count.height);
        for (size_t i = 0; i < n; ++i) out[c][i] = image.color[i][int(c)];
    }
    return out;
}

/// The predicted Gaussians, `scale` times as wide as with c = 2.
FilterField predicted_filters(std::span<const covariance::Sym2<float>> spectrum, int w, int h,
                              float scale) {
    FilterSettings settings;
    settings.c = 2 / scale;
    settings.limits = {0.35f, std::max(1.0f, 0.03f * float(w))};
    FilterField field = filter_field(spectrum, w, h, FilterRule::verified, settings);
    limit_by_neighbours(field, settings);
    return field;
}

std::vector<Candidate> make_candidates(const Halves& halves,
                                       std::span<const covariance::Sym2<float>> spectrum,
                                       const HybridSettings& settings) {
    const int w = halves[0].count.width, h = halves[0].count.height;
    std::vector<Candidate> candidates{{halves[0].color, halves[1].color}};
    for (float scale : settings.gaussians) {
        const FilterField field = predicted_filters(spectrum, w, h, scale);
        candidates.push_back({gaussian(halves[0], field), gaussian(halves[1], field)});
    }
    const FilterField shape = predicted_filters(spectrum, w, h, 1);
    std::vector<RegressionWindow> windows;
    for (const auto& fit : settings.fits)
        windows.push_back({fit.k, fit.shaped ? &shape : nullptr, kWindowWidening});
    const FeaturePlanes features = filter_features(halves);
    auto a = regress(halves[0], halves[1], features, windows);
    auto b = regress(halves[1], halves[0], features, windows);
    for (size_t k = 0; k < windows.size(); ++k)
        candidates.push_back({std::move(a[k]), std::move(b[k])});
    return candidates;
}

ColorPlanes mean_of(const Halves& halves) {
    ColorPlanes mean = halves[0].color;
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < mean[c].size(); ++i)
            mean[c][i] = 0.5f * (mean[c][i] + halves[1].color[c][i]);
    return mean;
}

/// The brightness that errors are measured against: the mean over all candidates but the raw one.
Plane common_brightness(std::span<const Candidate> candidates) {
    const size_t first = candidates.size() > 1 ? 1 : 0;
    Plane sum(candidates[0][0][0].width, candidates[0][0][0].height);
    for (size_t c = first; c < candidates.size(); ++c)
        for (const ColorPlanes& half : candidates[c])
            for (const Plane& channel : half)
                for (size_t i = 0; i < sum.size(); ++i) sum[i] += channel[i];
    const float scale = 1 / float(6 * (candidates.size() - first));
    for (float& v : sum.values) v = std::max(0.0f, v * scale);
    return sum;
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
    const std::vector<Candidate> candidates = make_candidates(halves, spectrum, settings);
    for (HalfBuffer& half : halves) half.feature = half.feature_variance = {};  // large, not needed
    const Plane brightness = common_brightness(candidates);
    Selection s = select(halves, candidates, brightness, settings.sigma, settings.mix);

    HybridImage image{std::move(s.half[0]), std::move(s.error), {}, std::move(s.share)};
    // A fit may leave the range of its colours: light is never negative.
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < brightness.size(); ++i)
            image.color[c][i] = std::max(0.0f, 0.5f * (image.color[c][i] + s.half[1][c][i]));
    return_energy(all, image.color);
    // The half that judges also chose weights and shares, which hides about half of the error that
    // is not the raw pixels'; measured, see docs/reconstruction.md.
    constexpr float kHidden = 1;
    for (size_t i = 0; i < brightness.size(); ++i)
        image.relative_error[i] *= 1 + kHidden * (1 - image.share[0][i]);
    image.variance = image.relative_error;
    for (size_t i = 0; i < brightness.size(); ++i)
        image.variance[i] *= sqr(brightness[i]) + kDarkSquared;
    return image;
}

}  // namespace covtrace
