/// One render from scene to image: passes, plan, reconstruction, layers.
#pragma once

#include "integrator/render_scene.h"
#include "render/keeping.h"
#include "render/options.h"
#include "render/progress.h"
#include "render/render_result.h"

namespace covtrace {

/// Renders a scene. Throws Error(limit) where memory runs out, Error(usage) where `keeping` asks
/// for what cannot be.
RenderResult render(const RenderScene& scene, const RenderOptions& options, Monitor& monitor,
                    FilmKeeping keeping = {});

}  // namespace covtrace
