/// Makes participating media of the directive MakeNamedMedium.
#pragma once

#include "pbrt/build_context.h"
#include "pbrt/current_transform.h"

namespace covtrace {

/// Builds a medium; grids lie in `space`. Errors: Error(scene) for
/// unknown types, for coefficients out of range and for grids that lack values.
MediumDescription build_medium(std::string name, Entity& entity, const CurrentTransform& space,
                               BuildContext& context);

}  // namespace covtrace
