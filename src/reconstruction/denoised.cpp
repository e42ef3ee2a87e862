#include "reconstruction/denoised.h"

#include <utility>

#include "core/error.h"

namespace covtrace {

namespace {

FeatureCleaning cleaning_of(DenoiserQuality quality, float few) {
    if (quality == DenoiserQuality::fast) return FeatureCleaning::none;
    // Noisy features are smoothed in about a third of the time as a draft, and the image errs 0.7 %
    // more at 16 samples (docs/decisions/0085), but 2 % at 4, and 8 % behind a lens (0117)
    return few == 0 ? FeatureCleaning::draft : FeatureCleaning::thorough;
}

/// Turns the results of two sights into their mean, in `upright`, and their difference.
void combine_sights(ColorPlanes& upright, ColorPlanes& turned) {
    for (size_t k = 0; k < 3; ++k)
        for (size_t i = 0; i < upright[k].size(); ++i) {
            const float u = upright[k][i], t = turned[k][i];
            upright[k][i] = 0.5f * (u + t);
            turned[k][i] = u - t;
        }
}

/// The second half whose mean with the first one is the whole: a filter that is linear would make
/// it, and the time of a network is saved.
ColorPlanes other_half(const ColorPlanes& half, const ColorPlanes& whole) {
    ColorPlanes other = whole;
    for (size_t k = 0; k < 3; ++k)
        for (size_t i = 0; i < other[k].size(); ++i) other[k][i] = 2 * whole[k][i] - half[k][i];
    return other;
}

/// Denoises all samples in both sights, and the halves where they are to judge.
Denoised denoised_twice(const Denoiser& denoiser, const NoisyFeatures& features,
                        const Halves& halves, const ColorPlanes& all, bool judges) {
    std::vector<NoisyImage> images{{.color = all}, {.color = all, .turned = true}};
    if (judges)
        for (const HalfBuffer& half : halves)
            images.push_back({.color = half.color, .draft = true});
    std::vector<ColorPlanes> results = denoiser.denoise(features, std::move(images));
    Denoised clean;
    clean.whole = std::move(results[0]);
    combine_sights(clean.whole, clean.difference.emplace(std::move(results[1])));
    for (size_t k = 0; k < 2; ++k) clean.half[k] = judges ? std::move(results[2 + k]) : clean.whole;
    return clean;
}

/// Denoises one half and all samples.
Denoised denoised_fast(const Denoiser& denoiser, const NoisyFeatures& features,
                       const Halves& halves, const ColorPlanes& all) {
    std::vector<ColorPlanes> results =
        denoiser.denoise(features, {{.color = halves[0].color, .draft = true}, {.color = all}});
    Denoised clean;
    clean.half[0] = std::move(results[0]);
    clean.whole = std::move(results[1]);
    clean.half[1] = other_half(clean.half[0], clean.whole);
    return clean;
}

}  // namespace

std::optional<Denoised> denoised(const Denoiser* denoiser, DenoiserQuality quality,
                                 const Halves& halves, float few, std::string& failure) {
    if (!denoiser) return std::nullopt;
    // No samples have planned others up to 4 per pixel
    const bool is_pilot = few >= 1;
    const CountBy by = is_pilot ? CountBy::samples : CountBy::halves;
    const ColorPlanes all = mean_color(halves, by);
    const NoisyFeatures features{mean_features(halves, 0, by), mean_features(halves, 3, by),
                                 cleaning_of(quality, few)};
    try {
        return quality == DenoiserQuality::fast
                   ? denoised_fast(*denoiser, features, halves, all)
                   : denoised_twice(*denoiser, features, halves, all, !is_pilot);
    } catch (const Error& e) {
        failure = e.what();
        return std::nullopt;
    }
}

}  // namespace covtrace
