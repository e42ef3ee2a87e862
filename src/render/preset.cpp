#include "render/preset.h"

#include <algorithm>

namespace covtrace {

// A draft has no denoiser, which alone takes about as long as its samples, and ends paths where
// most scenes have lost nine tenths of their light. 32 samples are the least of which the halves
// tell their errors well; 512 leave noise in hard scenes only. The numbers are round on purpose:
// they are names for what users choose by hand, and no optimum of any scene.
PresetValues values_of(Preset preset) {
    switch (preset) {
        case Preset::draft:
            return {4, 4, false};
        case Preset::preview:
            return {32, 8, true};
        case Preset::final:
            break;
    }
    return {512, std::nullopt, true};
}

void apply(Preset preset, const SceneOverrides& overrides, SceneDescription& scene,
           RenderOptions& options) {
    const PresetValues values = values_of(preset);
    const bool has_budget =
        options.spp || options.seconds || options.error || options.density_factor;
    if (!has_budget) options.spp = values.spp;
    if (!overrides.max_depth && values.most_depth)
        scene.max_depth = std::min(scene.max_depth, *values.most_depth);
}

}  // namespace covtrace
