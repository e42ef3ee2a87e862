/// Makes participating media of the directive MakeNamedMedium.
#pragma once

#include "pbrt/build_context.h"

namespace covtrace {

/// Builds a medium. Errors: Error(scene) for unknown types and coefficients out of range.
MediumDescription build_medium(std::string name, Entity& entity, BuildContext& context);

}  // namespace covtrace
