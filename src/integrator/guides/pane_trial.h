/// Whether sampling light through panes pays: where glass stands before lamps and sky, not where it
/// bends their light away.
#pragma once

#include "integrator/guides/guide_outcome.h"

namespace covtrace {

struct LitScene;

/// Tries it on paths from the camera that no guide leads. It pays where it takes away a
/// larger share of the noise than it adds to the time, as its rays tell. The outcome is
/// deterministic; `unused` where there are no panes to sample light through. Without a trial panes
/// are sampled through.
GuideOutcome try_panes(const LitScene& scene);

}  // namespace covtrace
