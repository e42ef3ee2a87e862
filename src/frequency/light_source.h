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

/// Makes the light field that leaves a surface without lighting: the same in all directions, with
/// the variation `texture` of its colour along the axes of surface.t1, t2.
LightField unlit_field(const covariance::Surface<double>& surface,
                       const covariance::Motion<double>& motion,
                       const covariance::Sym2<double>& texture, Vec3 travel);

/// The light as covariance::diffuse_window takes it: an emitter for a diffuse receiver `distance`
/// away (scene units).
covariance::Emitter<double> emitter_of(const SourceSpectrum& source, double distance);

}  // namespace covtrace
