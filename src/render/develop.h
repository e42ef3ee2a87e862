/// The image of a film: nothing but the render's state goes into it.
#pragma once

#include "image/image.h"
#include "prediction/covariance_buffer.h"
#include "reconstruction/hybrid.h"
#include "render/render_state.h"

namespace covtrace {

/// All samples as one film.
Film whole_film(const RenderState& state);

/// What the halves and covariances of a `hybrid` render give.
struct Reconstructed {
    const HybridImage& image;
    const Prediction& prediction;  ///< of the smoothed covariances
};

/// The image with all layers of the method, also of an unfinished render, and the metadata that the
/// state knows. `denoiser`: of `hybrid`, null: none; the metadata name it, or say why it failed.
Image develop(const RenderState& state, const Denoiser* denoiser = nullptr);
/// The same of a `hybrid` render where the reconstruction is known already.
Image develop(const RenderState& state, const Denoiser* denoiser,
              const Reconstructed& reconstructed);

}  // namespace covtrace
