#include "reconstruction/hybrid.h"

#include <algorithm>
#include <cmath>

#include "reconstruction/feature_filter.h"
#include "reconstruction/gather.h"
#include "reconstruction/outliers.h"
#include "reconstruction/regression.h"
#include "reconstruction/selector.h"

namespace covtrace {

namespace {

ColorPlanes gaussian(const HalfBuffer& half, const FilterField& field) {
    const size_t n = half.count.size();
    std::vector<Rgb> mean(n);
    std::vector<float> variance(n, 0.0f);
    std::vector<uint32_t> count(n);
    for (size_t i = 0; i < n; ++i) {
        mean[i] = {half.color[0][i], half.color[1][i], half.color[2][i]};
        count[i] = half.count[i] > 0 ? 1 : 0;
    }
    const GatheredImage image = gather(mean, variance, count, field);
    ColorPlanes out;
    out.fill(Plane(half.count.width, half.count.height));
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < n; ++i) out[c][i] = image.color[i][int(c)];
    return out;
}

}  // namespace

HybridImage reconstruct(Halves halves, std::span<const covariance::Sym2<float>> spectrum,
                        const HybridSettings& settings) {
    const int w = halves[0].count.width, h = halves[0].count.height;
    if (settings.rescale) rescale_variance(halves);
    ColorPlanes excess;
    if (settings.outliers) excess = split_outliers(halves);
    const FeaturePlanes features = filter_features(halves);
    std::vector<Candidate> candidates;
    candidates.push_back({halves[0].color, halves[1].color});
    const auto scaled = [&](float scale) {
        FilterSettings f;
        f.c = 2 / scale;
        f.limits = {0.35f, 0.03f * float(w)};
        FilterField field = filter_field(spectrum, w, h, FilterRule::verified, f);
        limit_by_neighbours(field, f);
        return field;
    };
    for (float scale : settings.gaussians) {
        const FilterField field = scaled(scale);
        candidates.push_back({gaussian(halves[0], field), gaussian(halves[1], field)});
    }
    const FilterField shape = scaled(1);
    std::vector<RegressionWindow> windows;
    for (const auto& f : settings.fits)
        windows.push_back({f.k, f.shaped ? &shape : nullptr, 2.5f, f.features});
    const auto a = regress(halves[0], halves[1], features, windows);
    const auto b = regress(halves[1], halves[0], features, windows);
    for (size_t k = 0; k < windows.size(); ++k) candidates.push_back({a[k], b[k]});

    // A common brightness: the mean of all candidates but the raw one.
    ColorPlanes mean;
    mean.fill(Plane(w, h));
    for (size_t c = 1; c < candidates.size(); ++c)
        for (size_t half = 0; half < 2; ++half)
            for (size_t k = 0; k < 3; ++k)
                for (size_t i = 0; i < mean[k].size(); ++i)
                    mean[k][i] += candidates[c][half][k][i] / float(2 * (candidates.size() - 1));
    Plane brightness(w, h);
    for (size_t i = 0; i < brightness.size(); ++i)
        brightness[i] = std::max(0.0f, (mean[0][i] + mean[1][i] + mean[2][i]) / 3);
    Selection s = select(halves, candidates, brightness, settings.sigma, settings.mix);
    for (Plane& p : s.color)
        for (float& v : p.values) v = std::max(0.0f, v);
    if (settings.outliers) add_excess(excess, s.color);
    return {std::move(s.color), std::move(s.error), std::move(s.share)};
}

}  // namespace covtrace
