#include "hybrid_samples.h"

#include "planner/covariance_buffer.h"
#include "render/hybrid_film.h"

namespace covtrace {

HybridSamples read_hybrid_samples(const std::filesystem::path& film) {
    const RenderState state = read_film(film);
    if (state.films.size() != 2)
        throw Error(ErrorKind::usage, film.string() + ": not of --method hybrid");
    return {state.region, state.mean_count(), halves_of(state.films),
            preintegrate(smooth(state.covariance())).spectrum};
}

HybridSettings plain_regression() {
    HybridSettings settings;
    settings.candidates.gaussians.clear();
    settings.candidates.fits = {{0.5f}, {1}};
    settings.mix = false;
    return settings;
}

}  // namespace covtrace
