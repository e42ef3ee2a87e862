/// Making the image of a film: nothing but the render's state goes into it.
#pragma once

#include "image/image.h"
#include "prediction/covariance_buffer.h"
#include "reconstruction/hybrid.h"
#include "render/render_state.h"

namespace covtrace {

/// The samples of all the state's films, as one film.
Film whole_film(const RenderState& state);

/// The reconstruction of a `hybrid` render: the image that halves and covariances give, and the
/// prediction behind it.
struct Reconstructed {
    const HybridImage& image;
    const Prediction& prediction;  ///< of the smoothed covariances
};

/// Makes the image with all layers of the method, also of an unfinished render, and the metadata
/// that the state knows. `denoiser` is for `hybrid`, null for none; the metadata name it with its
/// quality, or say why it failed.
Image develop(const RenderState& state, const Denoiser* denoiser = nullptr,
              DenoiserQuality quality = DenoiserQuality::high);
/// Makes the image of a `hybrid` render whose reconstruction is known already.
Image develop(const RenderState& state, const Denoiser* denoiser, DenoiserQuality quality,
              const Reconstructed& reconstructed);

}  // namespace covtrace
