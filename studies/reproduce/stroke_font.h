/// A font of lines, for text in pictures without any font file.
#pragma once

#include <string>
#include <vector>

#include "core/vec.h"

namespace covtrace::reproduce {

/// Sizes of the font: capitals are 6 units high, the base line is y = 0 and y points down; every
/// letter is 6 units wide with its space.
inline constexpr float kCapital = 6, kAdvance = 6;

/// The lines of a text from (0, 0), one after the other. UTF-8; letters beyond ASCII that the font
/// lacks become '?'.
std::vector<std::vector<Vec2>> strokes_of(const std::string& text);

/// Number of letters in a text, each of them kAdvance wide.
size_t letters_in(const std::string& text);

}  // namespace covtrace::reproduce
