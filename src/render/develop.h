/// The image of a film: nothing but the render's state goes into it.
#pragma once

#include "image/image.h"
#include "reconstruction/hybrid.h"
#include "render/render_state.h"

namespace covtrace {

/// All samples as one film.
Film whole_film(const RenderState& state);

/// The image with all layers of the method, also of an unfinished render, and the metadata that the
/// state knows. `reconstructed`: what the halves of `hybrid` give, where it is known already.
Image develop(const RenderState& state, const HybridImage* reconstructed = nullptr);

}  // namespace covtrace
