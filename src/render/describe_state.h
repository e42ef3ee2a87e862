/// Description of a film in words, for `covtrace info`.
#pragma once

#include <string>

#include "render/render_state.h"

namespace covtrace {

/// Describes a film in several lines for people: the method, where it stands, what it was asked
/// for, what it holds.
std::string describe(const RenderState& state);

}  // namespace covtrace
