#include "support/hybrid_samples.h"

#include "denoiser/find_denoiser.h"
#include "prediction/covariance_buffer.h"
#include "render/hybrid_film.h"

namespace covtrace {

HybridSamples read_hybrid_samples(const std::filesystem::path& film) {
    const RenderState state = read_film(film);
    if (state.films.size() != 2)
        throw Error(ErrorKind::usage, film.string() + ": not of --method hybrid");
    return {state.region, state.mean_count(), halves_of(state.films),
            preintegrated(smoothed(state.covariance())).spectrum};
}

std::shared_ptr<const Denoiser> required_denoiser() {
    // Tools are in build/PRESET/bench, the library in build/denoiser.
    const std::filesystem::path folder =
        std::filesystem::read_symlink("/proc/self/exe").parent_path();
    return find_denoiser({DenoiserChoice::oidn, {}, {folder / "../../denoiser"}}).denoiser;
}

HybridSettings plain_regression() {
    HybridSettings settings;
    settings.candidates.gaussians.clear();
    settings.candidates.fits = {{0.5f}, {1}};
    settings.mix = false;
    return settings;
}

}  // namespace covtrace
