#include "reconstruction/hybrid.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/display_exposure.h"
#include "core/error.h"
#include "core/vec.h"
#include "reconstruction/denoised.h"
#include "reconstruction/denoiser_blend.h"
#include "reconstruction/guides.h"
#include "reconstruction/luminance.h"
#include "reconstruction/outliers.h"
#include "reconstruction/raw_share.h"
#include "reconstruction/selector.h"
#include "reconstruction/undershoot.h"

namespace covtrace {

namespace {

/// 1 where both halves have samples, and can judge each other, 0 where one of them has, averaged
/// over a few pixels around.
Plane judged_pixels(const Halves& halves) {
    constexpr float kAround = 4;  // deviation, pixels
    Plane judged = halves[0].count;
    bool all = true;
    for (size_t i = 0; i < judged.size(); ++i) {
        judged[i] = judged[i] > 0 && halves[1].count[i] > 0 ? 1.0f : 0.0f;
        all = all && judged[i] > 0;
    }
    return all ? judged : gaussian_blur(judged, kAround);
}

/// How few samples the halves have: 0 from 16 per pixel of both together on, below that linear in
/// the variance of a pixel, 1 with 4 samples and 5 with a single one or less. Halves with noise of
/// their own, as of other renderers, never count as few.
float fewness(const Halves& halves, HalvesNoise noise) {
    constexpr double kFew = 4, kEnough = 16;
    if (noise != HalvesNoise::of_one_sequence) return 0;
    double samples = 0;
    for (const HalfBuffer& half : halves)
        for (float count : half.count.values) samples += double(count);
    const double mean = std::max(1.0, samples / double(halves[0].count.size()));
    return float(std::max(0.0, (kEnough / mean - 1) / (kEnough / kFew - 1)));
}

/// Brightness that errors are measured against, as a first guess: the mean over all candidates but
/// the raw one, the same for all channels.
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

Plane mean_of(Plane a, const Plane& b) {
    for (size_t i = 0; i < a.size(); ++i) a[i] = 0.5f * (a[i] + b[i]);
    return a;
}

ColorPlanes mean_of(const Selection& s) {
    ColorPlanes mean;
    for (size_t c = 0; c < 3; ++c) mean[c] = mean_of(s.half[0][c], s.half[1][c]);
    return mean;
}

/// The light of all samples that is not in the halves any more.
ColorPlanes cut_off(ColorPlanes all, const Halves& halves) {
    for (size_t k = 0; k < 3; ++k)
        for (size_t i = 0; i < all[k].size(); ++i)
            all[k][i] -= 0.5f * (halves[0].color[k][i] + halves[1].color[k][i]);
    return all;
}

/// Blends the selection's mixture with the denoiser's results: the mixture keeps the share `own` of
/// every pixel, and the denoiser gets the rest as one more candidate. In `image` that part is from
/// all samples denoised together, which is cleaner than the mean of the denoised halves.
void blend(const Plane& own, const Denoised& clean, Selection& s, ColorPlanes& image) {
    const auto mix = [&](Plane& ours, const Plane& theirs) {
        for (size_t i = 0; i < own.size(); ++i)
            ours[i] = own[i] * ours[i] + (1 - own[i]) * theirs[i];
    };
    for (Plane& share : s.share)
        for (size_t i = 0; i < own.size(); ++i) share[i] *= own[i];
    s.share.emplace_back(own);
    for (float& v : s.share.back().values) v = 1 - v;
    for (size_t k = 0; k < 3; ++k) {
        for (size_t half = 0; half < 2; ++half) mix(s.half[half][k], clean.half[half][k]);
        mix(image[k], clean.whole[k]);
    }
}

/// Keeps an image from being negative where the samples are not and, where they are, from being
/// more negative than they.
void keep_sign(const ColorPlanes& samples, ColorPlanes& color) {
    for (size_t k = 0; k < 3; ++k)
        for (size_t i = 0; i < color[k].size(); ++i)
            color[k][i] = std::max(std::min(0.0f, samples[k][i]), color[k][i]);
}

void set_error(ErrorEstimate error, float dark_squared, HybridImage& image) {
    image.relative_error = std::move(error.color);
    image.variance = std::move(error.luminance);
    const Plane bright = luminance(image.color);
    for (size_t i = 0; i < bright.size(); ++i) image.variance[i] *= sqr(bright[i]) + dark_squared;
}

const ColorPlanes* difference_of_sights(const Denoised& clean) {
    return clean.difference ? &*clean.difference : nullptr;
}

/// The image that is the denoiser's alone, with the light that it lost: of DenoiserQuality::fast,
/// and of the few samples of a pilot, whose halves are too noisy to tell where our own candidates
/// are better: they would gain 2 % of the error at most in half as much time again
/// (docs/decisions/0157). `all`: the mean of the halves.
HybridImage denoisers_image(const Halves& halves, const ColorPlanes& all, const Denoised& clean,
                            float few, const HybridSettings& settings, float dark_squared) {
    HybridImage image;
    image.color = clean.whole;
    keep_sign(all, image.color);
    const ColorPlanes brightness = image.color;
    LightReturn(halves, settings.noise, few).give_back(all, image.color);
    const int w = all[0].width, h = all[0].height;
    const Selection denoisers{clean.half, {Plane(w, h, 1)}};
    set_error(
        estimate_error(halves, std::span(&clean.half, 1), denoisers, image.color, all, brightness,
                       difference_of_sights(clean),
                       clean.difference ? settings.error_few : settings.error_fast, dark_squared),
        dark_squared, image);
    const CandidateSettings& own = settings.candidates;
    image.share.assign(1 + own.gaussians.size() + own.fits.size(), Plane(w, h));
    image.share.push_back(denoisers.share[0]);
    return image;
}

/// Multiplies the light of both halves.
void expose(Halves& halves, float factor) {
    for (HalfBuffer& half : halves)
        for (size_t k = 0; k < 3; ++k) {
            for (float& v : half.color[k].values) v *= factor;
            for (float& v : half.color_variance[k].values) v *= sqr(factor);
        }
}

/// `reconstruct` for halves without holes that have been multiplied by `exposure`, of which
/// `relative_error` knows. The rest of the image is in the units of the halves.
HybridImage reconstruct_exposed(Halves halves, std::span<const covariance::Sym2<float>> spectrum,
                                const HybridSettings& settings, float exposure) {
    // Denoise what the samples give
    const ColorPlanes all = mean_color(halves);
    const float dark_squared = kDarkSquared * sqr(exposure);
    HybridImage image;
    const float few = fewness(halves, settings.noise);
    const std::optional<Denoised> clean =
        denoised(settings.denoiser, settings.quality, halves, few, image.denoiser_failure);
    if (clean && (settings.quality == DenoiserQuality::fast || few >= 1))
        return denoisers_image(halves, all, *clean, few, settings, dark_squared);
    std::array<ColorPlanes, 2> samples, variance;  // the halves before anything is cut off
    if (clean)
        for (size_t k = 0; k < 2; ++k) {
            samples[k] = halves[k].color;
            variance[k] = halves[k].color_variance;
        }
    // Limit rare bright paths; light_return knows the halves as they were
    const LightReturn light_return(halves, settings.noise, clean ? few : 0);
    limit_outliers(halves);
    const Plane noise = pixel_noise(halves);
    // Smooth the variances: unsmoothed ones follow their own pixel's mean, and would let bright
    // pixels accept dark ones and not the other way round
    for (HalfBuffer& half : halves)
        for (Plane& v : half.color_variance) v = box_blur(v, 1);
    // Make the candidates and the guides that tell which pixels are alike
    std::vector<Candidate> candidates = make_candidates(halves, spectrum, settings.candidates);
    Likeness likeness(settings.likeness);
    add_features(halves, likeness);
    // Free the features: they are large, and the candidates and guides have been made of them.
    for (HalfBuffer& half : halves) half.feature = half.feature_variance = {};
    // Select twice, as candidates that spread highlights also lift the first guess of dark pixels,
    // which hides their errors there, and as the guess tells which pixels are alike
    const ColorPlanes first_guess = without_undershoot(common_brightness(candidates), halves);
    const ColorPlanes guess =
        without_undershoot(mean_of(select(halves, candidates, error_weights(halves, first_guess),
                                          settings.sigma, settings.mix)),
                           halves);
    add_light_and_noise(halves, guess, likeness);
    // Mix the candidates, then our own mixture with the denoiser's image
    const ColorPlanes g = error_weights(halves, guess);
    const std::array<Plane, 2> relative = relative_noise(noise, g);
    Selection s = select(halves, candidates, g, likeness, settings.mix, relative);
    if (settings.mix) lower_share_of_noisy(relative[0], s.around, candidates[0], s);
    fill_undershoot(candidates, halves, s);
    image.color = mean_of(s);
    if (clean) {
        const ColorPlanes lost = cut_off(all, halves),
                          g_blend = error_weights(halves, prior_blend(image.color, *clean));
        Plane own = own_share({samples, variance, s.half, lost, g_blend}, *clean, likeness);
        const Plane judged = judged_pixels(halves);
        for (size_t i = 0; i < own.size(); ++i) own[i] *= judged[i];
        blend(own, *clean, s, image.color);
        candidates.push_back(clean->half);
    }

    keep_sign(all, image.color);
    // Give light back, and estimate the error of what is delivered
    light_return.give_back(all, image.color);
    set_error(estimate_error(halves, candidates, s, image.color, all, guess,
                             clean ? difference_of_sights(*clean) : nullptr,
                             clean ? settings.error_denoised : settings.error, dark_squared),
              dark_squared, image);
    image.share = std::move(s.share);
    return image;
}

}  // namespace

HybridImage reconstruct(Halves halves, std::span<const covariance::Sym2<float>> spectrum,
                        const HybridSettings& settings) {
    for (HalfBuffer& half : halves) fill_holes(half);
    replace_empty_half(halves);
    // Bring dim images to where the constants are meant
    const float exposure = display_exposure(luminance(mean_color(halves)));
    expose(halves, exposure);
    HybridImage image = reconstruct_exposed(std::move(halves), spectrum, settings, exposure);
    for (Plane& channel : image.color)
        for (float& v : channel.values) v /= exposure;
    for (float& v : image.variance.values) v /= sqr(exposure);
    return image;
}

}  // namespace covtrace
