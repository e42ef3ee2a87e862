/// Reads directives from tokens and hands them to the builder.
#pragma once

#include "pbrt/scene_builder.h"
#include "pbrt/token_stream.h"

namespace covtrace {

/// Reads to the end of the stream. Errors: Error(scene) with the place.
void parse_directives(TokenStream& tokens, SceneBuilder& builder, SceneFiles& files,
                      WarningLog& log);

}  // namespace covtrace
