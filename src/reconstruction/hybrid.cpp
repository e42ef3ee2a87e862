#include "reconstruction/hybrid.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/vec.h"
#include "reconstruction/guides.h"
#include "reconstruction/outliers.h"
#include "reconstruction/selector.h"

namespace covtrace {

namespace {

/// The light of the samples themselves: where one half has none, that of the other.
ColorPlanes mean_of(const Halves& halves) {
    ColorPlanes mean = halves[0].color;
    const Plane &a = halves[0].count, &b = halves[1].count;
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < mean[c].size(); ++i) {
            const float share = (a[i] > 0) == (b[i] > 0) ? 0.5f : (a[i] > 0 ? 1.0f : 0.0f);
            mean[c][i] = share * mean[c][i] + (1 - share) * halves[1].color[c][i];
        }
    return mean;
}

/// What a render that was interrupted at its start leaves: a half without samples is not black.
void replace_empty_half(Halves& halves) {
    for (size_t k = 0; k < 2; ++k)
        if (is_empty(halves[k])) {
            const Plane none = halves[k].count;
            halves[k] = halves[1 - k];
            halves[k].count = none;  // it judges nothing
        }
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

/// A fit may leave the range of its colours: light is never negative, but beside lamps under a
/// pixel filter with negative lobes, which the samples tell of.
ColorPlanes without_undershoot(ColorPlanes color, const ColorPlanes& samples) {
    const auto negative = [](const Plane& p) {
        return std::any_of(p.values.begin(), p.values.end(), [](float v) { return v < 0; });
    };
    if (std::none_of(samples.begin(), samples.end(), negative))
        for (Plane& channel : color)
            for (float& v : channel.values) v = std::max(0.0f, v);
    return color;
}

/// What the denoiser gets of a half, or of the mean of both.
NoisyImage noisy_image(const ColorPlanes& color, const HalfBuffer& a, const HalfBuffer& b) {
    NoisyImage image{color, {}, {}};
    const auto mean = [&](size_t f) {
        Plane p = a.feature[f];
        for (size_t i = 0; i < p.size(); ++i) p[i] = 0.5f * (p[i] + b.feature[f][i]);
        return p;
    };
    for (size_t k = 0; k < 3; ++k) {
        image.albedo[k] = mean(k);
        image.normal[k] = mean(3 + k);
    }
    return image;
}

/// Both halves and their mean, denoised; none where the denoiser fails, `failure` says why.
std::vector<ColorPlanes> denoised(const Denoiser* denoiser, const Halves& halves,
                                  const ColorPlanes& all, std::string& failure) {
    if (!denoiser) return {};
    try {
        return denoiser->denoise({noisy_image(halves[0].color, halves[0], halves[0]),
                                  noisy_image(halves[1].color, halves[1], halves[1]),
                                  noisy_image(all, halves[0], halves[1])});
    } catch (const Error& e) {
        failure = e.what();
        return {};
    }
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
    replace_empty_half(halves);
    const ColorPlanes all = mean_of(halves);
    HybridImage image;
    const std::vector<ColorPlanes> clean =
        denoised(settings.denoiser, halves, all, image.denoiser_failure);
    limit_outliers(halves);
    // Variances that know of their own pixel's mean would let bright pixels accept dark ones and
    // not the other way round.
    for (HalfBuffer& half : halves)
        for (Plane& v : half.color_variance) v = box_blur(v, 1);
    std::vector<Candidate> candidates = make_candidates(halves, spectrum, settings.candidates);
    if (!clean.empty()) candidates.push_back({clean[0], clean[1]});
    Likeness likeness(settings.likeness);
    add_features(halves, likeness);
    for (HalfBuffer& half : halves) half.feature = half.feature_variance = {};  // large, not needed
    // Twice, as candidates that spread highlights also lift the first guess of what is dark, which
    // hides their errors there; and as the guess tells which pixels are alike.
    const ColorPlanes first_guess = without_undershoot(common_brightness(candidates), all);
    const ColorPlanes guess =
        without_undershoot(mean_of(select(halves, candidates, error_weights(halves, first_guess),
                                          settings.sigma, settings.mix)),
                           all);
    add_light_and_noise(halves, guess, likeness);
    Selection s = select(halves, candidates, error_weights(halves, guess), likeness, settings.mix);

    image.color = mean_of(s);
    // All samples denoised together are cleaner than the mean of the denoised halves.
    if (!clean.empty())
        for (size_t k = 0; k < 3; ++k)
            for (size_t i = 0; i < all[k].size(); ++i)
                image.color[k][i] +=
                    s.share.back()[i] * (clean[2][k][i] - 0.5f * (clean[0][k][i] + clean[1][k][i]));
    // The image itself is negative only where the samples are, and no darker than they.
    for (size_t k = 0; k < 3; ++k)
        for (size_t i = 0; i < all[k].size(); ++i)
            image.color[k][i] = std::max(std::min(0.0f, all[k][i]), image.color[k][i]);
    const ReturnedShares returned = return_energy(all, image.color);
    ErrorEstimate error =
        estimate_error(halves, candidates, s, image.color, all, returned, guess, settings.error);
    image.share = std::move(s.share);
    image.relative_error = std::move(error.color);
    image.variance = std::move(error.luminance);
    const Plane bright = luminance(image.color);
    for (size_t i = 0; i < bright.size(); ++i) image.variance[i] *= sqr(bright[i]) + kDarkSquared;
    return image;
}

}  // namespace covtrace
