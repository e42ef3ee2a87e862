#include "reconstruction/candidates.h"

#include <algorithm>

#include "core/parallel.h"
#include "reconstruction/feature_filter.h"
#include "reconstruction/gather.h"
#include "reconstruction/regression.h"

namespace covtrace {

namespace {

/// Factor by which the windows of regressions reach further than the predicted filters.
constexpr float kWindowWidening = 2.5f;

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

}  // namespace

CandidateKind candidate_kind(const CandidateSettings& settings, size_t index) {
    if (index == 0) return CandidateKind::raw;
    if (index <= settings.gaussians.size()) return CandidateKind::gaussian;
    return index <= settings.gaussians.size() + settings.fits.size() ? CandidateKind::regression
                                                                     : CandidateKind::denoiser;
}

std::vector<Candidate> make_candidates(const Halves& halves,
                                       std::span<const covariance::Sym2<float>> spectrum,
                                       const CandidateSettings& settings) {
    const int w = halves[0].count.width, h = halves[0].count.height;
    std::vector<Candidate> candidates{{halves[0].color, halves[1].color}};
    const bool is_predicted = !spectrum.empty();
    // The scales are those of the Gaussians and, last, that of the regressions' windows.
    std::vector<float> scales;
    if (is_predicted) {
        scales = settings.gaussians;
        scales.push_back(1);
    }
    std::vector<FilterField> fields(scales.size());
    parallel_for(int64_t(scales.size()), [&](int64_t k) {
        fields[size_t(k)] = predicted_filters(spectrum, w, h, scales[size_t(k)]);
    });
    const FilterField* shape = is_predicted ? &fields.back() : nullptr;
    for (size_t k = 0; k + 1 < fields.size(); ++k) {
        candidates.push_back(gather(halves, fields[k]));
        fields[k] = {};  // free it: it is large and not needed any more
    }
    std::vector<RegressionWindow> windows;
    for (const auto& fit : settings.fits)
        windows.push_back(
            {fit.k, fit.shaped ? shape : nullptr, kWindowWidening, fit.noise, fit.patches});
    const std::array<FeaturePlanes, 2> features = filter_features(halves);
    auto a = regress(halves[0], halves[1], features[0], windows);
    auto b = regress(halves[1], halves[0], features[1], windows);
    for (size_t k = 0; k < windows.size(); ++k)
        candidates.push_back({std::move(a[k]), std::move(b[k])});
    return candidates;
}

}  // namespace covtrace
