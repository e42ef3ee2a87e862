/// The light of a path at its start: from a light's shape to the covariance of the light that
/// leaves it.
#pragma once

#include "covariance/covariance.hpp"
#include "light/source_spectrum.h"

namespace covtrace {

using LightField = covariance::LightField<double>;

/// Makes the light field that leaves a light in the direction `travel` (unit, world).
///
/// Area lights are Gaussian emitters with the moments of the whole shape. Where the camera sees
/// them sharply (directly or by specular lobes alone) their border is an image edge, which adds the
/// bandwidth of an edge at its distance, and so does any variation on the light: `texture`, the
/// covariance of its spectrum along source.tangent's x and y, 1 / scene unit^2. `smallest` is the
/// extent that stands for a point, in scene units.
LightField source_field(const SourceSpectrum& source, Vec3 travel, bool seen_sharply,
                        double smallest, const covariance::Sym2<double>& texture = {});

/// The light as covariance::diffuse_window takes it: an emitter for a diffuse receiver `distance`
/// away (scene units).
covariance::Emitter<double> emitter_of(const SourceSpectrum& source, double distance);

}  // namespace covtrace
