#include "render/develop.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "image/finite_pixels.h"
#include "render/hybrid_film.h"
#include "render/layers.h"
#include "render/methods/covariance_image.h"

namespace covtrace {

namespace {

/// The layer `density`: what the last plan asked for; before the first plan, the mean count.
std::vector<float> density_layer(const RenderState& state) {
    if (!state.density.empty()) return state.density;
    return std::vector<float>(state.pixels(), float(state.mean_count()));
}

Image filtered_image(const RenderState& state) {
    const CovarianceBuffers& parts = state.parts();
    const CovarianceFilters filters = covariance_filters(state);
    const FilteredImage image = covariance_image(state, filters);
    const CovarianceBuffer all = merge(parts);
    const Prediction raw = preintegrated(all);
    return make_layers(state.films[0], state.display, state.has_holes,
                       CovarianceLayers{all, raw, density_layer(state), filters.scattered, image,
                                        filters.has_in_view ? &parts.scattered : nullptr,
                                        filters.has_in_view ? &filters.in_view : nullptr});
}

Image mixed_image(const RenderState& state, const CovarianceBuffer& all,
                  const Reconstructed& reconstructed) {
    const auto& [mixed, prediction] = reconstructed;
    FilteredImage delivered{std::vector<Rgb>(state.pixels()), mixed.variance.values, {}};
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

Image develop(const RenderState& state, const Denoiser* denoiser, DenoiserQuality quality) {
    switch (state.method) {
        case Method::uniform:
            return completed(
                make_layers(state.films[0], state.display, state.has_holes, std::nullopt), state);
        case Method::covariance:
            return completed(filtered_image(state), state);
        case Method::hybrid:
            break;
    }
    const Prediction prediction = preintegrated(smoothed(state.covariance()));
    HybridSettings settings;
    settings.denoiser = denoiser;
    settings.quality = quality;
    const HybridImage image = reconstruct(halves_of(state.films), prediction.spectrum, settings);
    return develop(state, denoiser, quality, {image, prediction});
}

Image develop(const RenderState& state, const Denoiser* denoiser, DenoiserQuality quality,
              const Reconstructed& reconstructed) {
    Image image = mixed_image(state, state.covariance(), reconstructed);
    const std::string& failure = reconstructed.image.denoiser_failure;
    if (!failure.empty()) {
        image.metadata["covtrace:denoiserFailure"] = failure;
    } else if (denoiser) {
        image.metadata["covtrace:denoiser"] = denoiser->name();
        image.metadata["covtrace:denoiserQuality"] = std::string(name_of(quality));
    }
    return completed(std::move(image), state);
}

}  // namespace covtrace
