#include "render/options.h"

namespace covtrace {

FilmDescription::Surfaces kept_surfaces(const FilmDescription& film, const RenderOptions& options) {
    using Surfaces = FilmDescription::Surfaces;
    return film.surfaces == Surfaces::none && options.surfaces ? Surfaces::world : film.surfaces;
}

std::optional<double> target_spp(const SceneDescription& scene, const RenderOptions& options) {
    const bool ends_otherwise = options.seconds || options.error || options.density_factor;
    if (!options.spp && ends_otherwise) return std::nullopt;
    return options.spp.value_or(scene.samples_per_pixel);
}

}  // namespace covtrace
