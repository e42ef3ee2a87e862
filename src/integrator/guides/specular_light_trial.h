/// Whether sampling light through panes, and by flat mirrors, pays: where glass stands before lamps
/// and sky, not where it bends their light away; where mirrors show lamps to much of what is seen.
#pragma once

#include "integrator/guides/guide_outcome.h"

namespace covtrace {

struct LitScene;

struct SpecularLightOutcomes {
    GuideOutcome panes, mirrors;
};

/// Tries both on the same paths from the camera, which no guide leads. Either pays where it takes
/// away a larger share of the noise than it adds to the time, as its rays tell. The outcomes are
/// deterministic; `unused` where there are no panes, or no mirrors, to sample light by. Without a
/// trial light is sampled by all of them.
SpecularLightOutcomes try_specular_light(const LitScene& scene);

}  // namespace covtrace
