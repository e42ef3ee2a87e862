/// Named bundles of options, for those who want a look or a final image and no details.
#pragma once

#include <optional>

#include "core/enum_names.h"
#include "render/options.h"
#include "render/overrides.h"

namespace covtrace {

enum class Preset {
    draft,    ///< to see whether everything is in its place
    preview,  ///< to judge light and materials
    final     ///< to keep
};

template <>
inline constexpr auto kEnumNames<Preset> = enum_names<Preset>({{Preset::draft, "draft"},
                                                               {Preset::preview, "preview"},
                                                               {Preset::final, "final"}});

struct PresetValues {
    double spp = 0;                 ///< samples per pixel, where no budget is given
    std::optional<int> most_depth;  ///< limits the scene's depth; none: the scene's
    // For `hybrid`, where they are not given; none: as without a preset.
    std::optional<double> cov_spp;
    std::optional<DenoiserQuality> denoiser_quality;
};
PresetValues values_of(Preset preset);

/// Sets options and the scene's depth as the preset says, where options and overrides, which have
/// been applied before, leave them open.
void apply(Preset preset, const SceneOverrides& overrides, SceneDescription& scene,
           RenderOptions& options);

}  // namespace covtrace
