#include "render/preset.h"

#include <algorithm>

namespace covtrace {

// A draft ends paths where most scenes have lost nine tenths of their light, analyses a fourth of
// its pixels, as its image has nothing of the analysis but layers, and is denoised in a time that
// is less than that of its samples. 32 samples are the least of which the halves tell their errors
// well; 512 leave noise in hard scenes only. The numbers are round on purpose: they are names for
// what users choose by hand, and no optimum of any scene.
PresetValues values_of(Preset preset) {
    switch (preset) {
        case Preset::draft:
            return {4, 4, 0.25, DenoiserQuality::fast};
        case Preset::preview:
            return {32, 8, std::nullopt, std::nullopt};
        case Preset::final:
            break;
    }
    return {512, std::nullopt, std::nullopt, std::nullopt};
}

void apply(Preset preset, const SceneOverrides& overrides, SceneDescription& scene,
           RenderOptions& options) {
    const PresetValues values = values_of(preset);
    const bool has_budget =
        options.spp || options.seconds || options.error || options.density_factor;
    if (!has_budget) options.spp = values.spp;
    if (!overrides.max_depth && values.most_depth)
        scene.max_depth = std::min(scene.max_depth, *values.most_depth);
    if (options.method != Method::hybrid) return;
    if (!options.cov_spp) options.cov_spp = values.cov_spp;
    if (!options.denoiser_quality) options.denoiser_quality = values.denoiser_quality;
}

}  // namespace covtrace
