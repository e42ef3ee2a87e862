#include "render/methods/covariance_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "reconstruction/filter_choice.h"
#include "reconstruction/gather.h"
#include "reconstruction/guided_gather.h"
#include "reconstruction/unfiltered_share.h"

namespace covtrace {

namespace {

/// Distance that stands for what is never hit, scene units.
constexpr float kFar = 1e6f;

/// One part of the light of a film: means, and variances of their luminance.
struct Part {
    std::vector<Rgb> mean;
    std::vector<float> variance;
};

struct Parts {
    Part scattered, in_view;
    std::vector<uint32_t> count;
    RawLuminance whole;
};

float luminance_variance(const FilmPixel& pixel) {
    // The channels of one sample vary together, so that the luminance is of the deviations.
    const Rgb v = pixel.variance_of_mean();
    return sqr(luminance({std::sqrt(v.r), std::sqrt(v.g), std::sqrt(v.b)}));
}

/// Variances of the means of pixels' luminance. A single sample tells none, which is not the same
/// as none: it has that of a sample around it, 0 where none is known.
Plane luminance_variances(const Film& film) {
    constexpr float kAround = 2;  // deviation of the Gaussian, pixels
    Plane variance(film.bounds.width(), film.bounds.height()), of_one = variance, known = variance;
    for (size_t i = 0; i < variance.size(); ++i) {
        const FilmPixel& pixel = film.pixels[i];
        if (pixel.count < 2) continue;
        variance[i] = luminance_variance(pixel);
        const float v = float(pixel.count) * variance[i];
        if (!std::isfinite(v)) continue;
        of_one[i] = v;
        known[i] = 1;
    }
    of_one = gaussian_blur(of_one, kAround);
    known = gaussian_blur(known, kAround);
    for (size_t i = 0; i < variance.size(); ++i)
        if (film.pixels[i].count == 1 && known[i] > 0) variance[i] = of_one[i] / known[i];
    return variance;
}

Parts parts_of(const Film& film) {
    const size_t n = film.pixels.size();
    const Plane variances = luminance_variances(film);
    const Part none{std::vector<Rgb>(n), std::vector<float>(n)};
    const Plane dark(film.bounds.width(), film.bounds.height());
    Parts parts{none, none, std::vector<uint32_t>(n), {dark, dark, std::vector<bool>(n)}};
    for (size_t i = 0; i < n; ++i) {
        const FilmPixel& pixel = film.pixels[i];
        parts.in_view.mean[i] = film.in_view[i];
        parts.scattered.mean[i] = pixel.mean - film.in_view[i];
        parts.count[i] = pixel.count;
        const float variance = variances[i];
        // The film knows the variance of the sum: each part has it by the square of its light.
        const float s = sqr(luminance(parts.scattered.mean[i])),
                    e = sqr(luminance(parts.in_view.mean[i]));
        const float scattered = s + e > 0 && std::isfinite(s + e) ? s / (s + e) : 1.0f;
        parts.scattered.variance[i] = scattered * variance;
        parts.in_view.variance[i] = (1 - scattered) * variance;
        parts.whole.value[i] = luminance(pixel.mean);
        parts.whole.variance[i] = variance;
        parts.whole.known[i] = pixel.count > 1;
    }
    return parts;
}

FilteredImage through(const Part& part, const std::vector<uint32_t>& count,
                      const FilterField& field) {
    return gather(part.mean, part.variance, count, field);
}

/// Samples per pixel beyond which emitters in view may have narrower filters: with fewer, pixels
/// that have missed an emitter by chance ask for them, and its light is lost (docs/decisions/0128).
constexpr double kEnoughForSharper = 4;

/// Filters half as wide.
FilterField narrowed(FilterField field) {
    for (auto& s : field.covariance) s = 0.25f * s;
    return field;
}

FilteredImage in_view_image(const Parts& parts, const CovarianceFilters& filters) {
    if (filters.has_in_view) return through(parts.in_view, parts.count, filters.in_view);
    return {parts.in_view.mean, parts.in_view.variance,
            std::vector<float>(parts.count.size(), 1.0f)};
}

/// Adds the other part of the light. A pixel's own weight is the mean of those of both parts, by
/// their variances.
void add(const Parts& parts, const FilteredImage& in_view, FilteredImage& image) {
    for (size_t i = 0; i < image.color.size(); ++i) {
        image.color[i] += in_view.color[i];
        image.variance[i] += in_view.variance[i];
        const float s = parts.scattered.variance[i], e = parts.in_view.variance[i];
        if (s + e > 0)
            image.own_weight[i] = (s * image.own_weight[i] + e * in_view.own_weight[i]) / (s + e);
    }
}

/// Light through its filters, and the features of what is seen first through the same: these have
/// lens and shutter in them, as the features do.
struct LedLight {
    FilteredImage light;
    FilterGuides guides;
};

LedLight led_light(const Film& film, const Parts& parts, const FilterField& field) {
    const size_t n = film.pixels.size();
    std::array<Plane, kGatheredFeatures> features;
    features.fill(Plane(field.width, field.height));
    for (size_t i = 0; i < n; ++i) {
        const FilmPixel& pixel = film.pixels[i];
        for (size_t c = 0; c < 3; ++c) {
            features[c][i] = pixel.albedo[int(c)];
            features[3 + c][i] = pixel.normal[int(c)];
        }
        const bool hit = pixel.depth > 0 && std::isfinite(pixel.depth);
        features[6][i] = std::log(hit ? pixel.depth : kFar);
    }
    LedLight led;
    led.light = gather(parts.scattered.mean, parts.scattered.variance, parts.count, field,
                       std::span<Plane, kGatheredFeatures>(features));
    led.guides = {std::vector<Rgb>(n), std::vector<Rgb>(n), std::move(features[6].values)};
    for (size_t i = 0; i < n; ++i) {
        led.guides.albedo[i] = {features[0][i], features[1][i], features[2][i]};
        led.guides.normal[i] = {features[3][i], features[4][i], features[5][i]};
    }
    return led;
}

/// The candidate whose luminance errors are relative to: led, at twice the predicted width, light
/// without its texture. Narrower ones are noisy, wider ones are far off more often
/// (docs/decisions/0108).
constexpr size_t kSteady = 3;

/// The luminance of a candidate, and of the other one where it found nothing.
Plane brightness_of(const RawLuminance& raw, const FilteredImage& candidate,
                    const FilteredImage& other) {
    Plane brightness(raw.value.width, raw.value.height);
    for (size_t i = 0; i < brightness.size(); ++i)
        brightness[i] =
            luminance((std::isfinite(candidate.variance[i]) ? candidate : other).color[i]);
    return brightness;
}

/// Mixes unfiltered pixels into an image where its filters cost more than they gain.
void mix_unfiltered(const Film& film, const RawLuminance& raw, FilteredImage& image) {
    FilteredLuminance l{Plane(raw.value.width, raw.value.height),
                        Plane(raw.value.width, raw.value.height), image.own_weight};
    for (size_t i = 0; i < image.color.size(); ++i) {
        l.value[i] = luminance(image.color[i]);
        l.variance[i] = image.variance[i];
    }
    const Plane share = unfiltered_share(raw, l);
    for (size_t i = 0; i < image.color.size(); ++i) {
        if (film.pixels[i].count == 0) continue;
        image.color[i] = (1 - share[i]) * image.color[i] + share[i] * film.pixels[i].mean;
        image.variance[i] = sqr(1 - share[i]) * image.variance[i] + sqr(share[i]) * raw.variance[i];
    }
}

/// Both parts of the light, each through its filters.
FilteredImage gathered_image(const Parts& parts, const CovarianceFilters& filters) {
    FilteredImage image = through(parts.scattered, parts.count, filters.scattered);
    add(parts, in_view_image(parts, filters), image);
    return image;
}

/// The candidates' mixture that the samples ask for.
FilteredImage judged_image(const Film& film, const Parts& parts, const CovarianceFilters& filters) {
    LedLight led = led_light(film, parts, filters.scattered);
    std::vector<FilteredImage> candidates = guided_gather(
        parts.scattered.mean, parts.scattered.variance, parts.count, filters.scattered, led.guides);
    candidates.insert(candidates.begin(), std::move(led.light));
    std::optional<FilteredImage> sharper;
    if (filters.has_in_view && film.mean_count() > kEnoughForSharper) {
        sharper = candidates.front();
        add(parts, through(parts.in_view, parts.count, narrowed(filters.in_view)), *sharper);
    }
    const FilteredImage in_view = in_view_image(parts, filters);
    for (FilteredImage& candidate : candidates) add(parts, in_view, candidate);
    if (sharper) candidates.push_back(std::move(*sharper));
    const Plane brightness = brightness_of(parts.whole, candidates[kSteady], candidates.front());
    FilteredImage image = mixed(candidates, choose_filters(parts.whole, candidates, brightness));
    mix_unfiltered(film, parts.whole, image);
    return image;
}

std::vector<bool> light_known(const std::vector<PackedCovariance>& covariances) {
    std::vector<bool> known(covariances.size());
    for (size_t i = 0; i < known.size(); ++i) known[i] = covariances[i].weight > 0;
    return known;
}

}  // namespace

CovarianceFilters covariance_filters(const RenderState& state) {
    const CovarianceBuffers& parts = state.parts();
    const double taken = state.films[0].mean_count();
    const FilterSettings settings = covariance::filter_settings(taken),
                         settings_in_view = covariance::filter_settings_in_view(taken);
    const auto filters_of = [&](const std::vector<PackedCovariance>& part,
                                const FilterSettings& its_settings) {
        const Prediction p =
            preintegrated(smoothed(unpack(part, state.region.width(), state.region.height())));
        return filter_field(p.spectrum, p.width, p.height, state.filter, its_settings);
    };
    CovarianceFilters filters{filters_of(parts.scattered, settings),
                              filters_of(parts.in_view, settings_in_view)};
    filters.has_in_view = std::any_of(parts.in_view.begin(), parts.in_view.end(),
                                      [](const PackedCovariance& c) { return c.weight > 0; });
    if (state.filter == FilterRule::verified || state.filter == FilterRule::predicted)
        covariance::limit_parts(filters.scattered, filters.in_view, light_known(parts.scattered),
                                light_known(parts.in_view), settings, settings_in_view);
    return filters;
}

FilteredImage covariance_image(const RenderState& state, const CovarianceFilters& filters) {
    const Film& film = state.films[0];
    const Parts parts = parts_of(film);
    return state.filter == FilterRule::verified ? judged_image(film, parts, filters)
                                                : gathered_image(parts, filters);
}

}  // namespace covtrace
