/// Reads `"type name" values` pairs into parameters.
#pragma once

#include <vector>

#include "pbrt/parameter_list.h"

namespace covtrace {

class TokenStream;

/// Reads all parameters up to the next directive. Values stand in brackets, or one stands alone.
/// Errors: Error(scene) with the place, for unknown types, values of the wrong kind, and types of
/// pbrt-v3.
std::vector<Parameter> parse_parameters(TokenStream& tokens, ColourSpace colour_space);

}  // namespace covtrace
