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
    bool denoises = true;           ///< whether a denoiser is looked for
};
PresetValues values_of(Preset preset);

/// Sets the samples and the scene's depth as the preset says, where options and overrides, which
/// have been applied before, leave them open. The denoiser is its caller's to leave out.
void apply(Preset preset, const SceneOverrides& overrides, SceneDescription& scene,
           RenderOptions& options);

}  // namespace covtrace
