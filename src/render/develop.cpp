#include "render/develop.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "image/finite_pixels.h"
#include "reconstruction/gather.h"
#include "reconstruction/unfiltered_share.h"
#include "render/hybrid_film.h"
#include "render/layers.h"

namespace covtrace {

namespace {

FilterField filters_of_smoothed(FilterRule rule, const CovarianceBuffer& buffer,
                                const FilterSettings& settings) {
    const Prediction p = preintegrated(smoothed(buffer));
    return filter_field(p.spectrum, p.width, p.height, rule, settings);
}

std::vector<bool> light_known(const std::vector<PackedCovariance>& covariances) {
    std::vector<bool> known(covariances.size());
    for (size_t i = 0; i < known.size(); ++i) known[i] = covariances[i].weight > 0;
    return known;
}

/// The layer `density`: what the last plan asked for; before the first plan, the mean count.
std::vector<float> density_layer(const RenderState& state) {
    if (!state.density.empty()) return state.density;
    return std::vector<float>(state.pixels(), float(state.mean_count()));
}

/// Gathers both parts of the light through their filters. `in_view_filters` is null where nothing
/// is known of emitters, which then stay as they are.
GatheredImage gathered(const Film& film, const FilterField& filters,
                       const FilterField* in_view_filters) {
    std::vector<Rgb> scattered(film.pixels.size());
    std::vector<float> variance(film.pixels.size());
    std::vector<uint32_t> count(film.pixels.size());
    for (size_t i = 0; i < scattered.size(); ++i) {
        const FilmPixel& pixel = film.pixels[i];
        scattered[i] = pixel.mean - film.in_view[i];
        const Rgb v = pixel.variance_of_mean();
        variance[i] = sqr(luminance({std::sqrt(v.r), std::sqrt(v.g), std::sqrt(v.b)}));
        count[i] = pixel.count;
    }
    GatheredImage image = gather(scattered, variance, count, filters);
    const std::vector<Rgb> in_view =
        in_view_filters ? gather(film.in_view, variance, count, *in_view_filters).color
                        : film.in_view;
    for (size_t i = 0; i < in_view.size(); ++i) image.color[i] += in_view[i];
    return image;
}

/// Mixes unfiltered pixels into a gathered image where its filters cost more than they gain.
void mix_unfiltered(const Film& film, const FilterField& filters, GatheredImage& image) {
    const int w = filters.width, h = filters.height;
    FilteredLuminance l{Plane(w, h), Plane(w, h), Plane(w, h), Plane(w, h), filters.covariance};
    for (size_t i = 0; i < image.color.size(); ++i) {
        const FilmPixel& pixel = film.pixels[i];
        const Rgb v = pixel.variance_of_mean();
        l.raw[i] = luminance(pixel.mean);
        l.raw_variance[i] = sqr(luminance({std::sqrt(v.r), std::sqrt(v.g), std::sqrt(v.b)}));
        l.gathered[i] = luminance(image.color[i]);
        l.gathered_variance[i] = image.variance[i];
    }
    const Plane share = unfiltered_share(l);
    for (size_t i = 0; i < image.color.size(); ++i) {
        if (film.pixels[i].count == 0) continue;
        image.color[i] = (1 - share[i]) * image.color[i] + share[i] * film.pixels[i].mean;
        image.variance[i] =
            sqr(1 - share[i]) * image.variance[i] + sqr(share[i]) * l.raw_variance[i];
    }
}

Image gathered_image(const RenderState& state) {
    const Film& film = state.films[0];
    const CovarianceBuffers& parts = state.parts();
    const double taken = film.mean_count();
    const FilterSettings settings = covariance::filter_settings(taken),
                         settings_in_view = covariance::filter_settings_in_view(taken);
    const auto filters_of = [&](const std::vector<PackedCovariance>& part,
                                const FilterSettings& its_settings) {
        return filters_of_smoothed(
            state.filter, unpack(part, state.region.width(), state.region.height()), its_settings);
    };
    FilterField field = filters_of(parts.scattered, settings);
    FilterField in_view_field = filters_of(parts.in_view, settings_in_view);
    if (state.filter == FilterRule::verified) {
        covariance::limit_parts(field, in_view_field, light_known(parts.scattered),
                                light_known(parts.in_view), settings, settings_in_view);
    }
    const bool emitters_found = std::any_of(parts.in_view.begin(), parts.in_view.end(),
                                            [](const PackedCovariance& c) { return c.weight > 0; });
    GatheredImage image = gathered(film, field, emitters_found ? &in_view_field : nullptr);
    if (state.filter == FilterRule::verified) mix_unfiltered(film, field, image);
    const CovarianceBuffer all = merge(parts);
    const Prediction raw = preintegrated(all);
    return make_layers(film, state.display, state.has_holes,
                       CovarianceLayers{all, raw, density_layer(state), field, image,
                                        emitters_found ? &parts.scattered : nullptr,
                                        emitters_found ? &in_view_field : nullptr});
}

Image mixed_image(const RenderState& state, const CovarianceBuffer& all,
                  const Reconstructed& reconstructed) {
    const auto& [mixed, prediction] = reconstructed;
    GatheredImage delivered{std::vector<Rgb>(state.pixels()), mixed.variance.values};
    for (size_t i = 0; i < state.pixels(); ++i)
        delivered.color[i] = {mixed.color[0][i], mixed.color[1][i], mixed.color[2][i]};
    const Prediction raw = preintegrated(all);
    const FilterField field =
        filter_field(prediction.spectrum, prediction.width, prediction.height, FilterRule::verified,
                     covariance::filter_settings(state.mean_count()));
    return make_layers(whole_film(state), state.display, state.has_holes,
                       CovarianceLayers{all, raw, density_layer(state), field, delivered, nullptr,
                                        nullptr, &mixed.share});
}

/// Completes an image with the state's metadata. Every image of a render passes here, so that all
/// are finite.
Image completed(Image image, const RenderState& state) {
    image.metadata.insert(state.metadata.begin(), state.metadata.end());
    image.metadata["spp"] = static_cast<float>(state.mean_count());
    image.metadata["complete"] = state.complete ? 1 : 0;
    replace_nonfinite(image);
    return image;
}

}  // namespace

Film whole_film(const RenderState& state) {
    return state.films.size() == 1 ? state.films[0] : merged(state.films);
}

Image develop(const RenderState& state, const Denoiser* denoiser) {
    switch (state.method) {
        case Method::uniform:
            return completed(
                make_layers(state.films[0], state.display, state.has_holes, std::nullopt), state);
        case Method::covariance:
            return completed(gathered_image(state), state);
        case Method::hybrid:
            break;
    }
    const Prediction prediction = preintegrated(smoothed(state.covariance()));
    HybridSettings settings;
    settings.denoiser = denoiser;
    const HybridImage image = reconstruct(halves_of(state.films), prediction.spectrum, settings);
    return develop(state, denoiser, {image, prediction});
}

Image develop(const RenderState& state, const Denoiser* denoiser,
              const Reconstructed& reconstructed) {
    Image image = mixed_image(state, state.covariance(), reconstructed);
    const std::string& failure = reconstructed.image.denoiser_failure;
    if (!failure.empty())
        image.metadata["covtrace:denoiserFailure"] = failure;
    else if (denoiser)
        image.metadata["covtrace:denoiser"] = denoiser->name();
    return completed(std::move(image), state);
}

}  // namespace covtrace
