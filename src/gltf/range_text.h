/// Private to this folder: the numbers that a value may have, in words.
#pragma once

#include <sstream>
#include <string>

namespace covtrace::gltf {

/// The number with up to 6 digits, as in "1.5".
inline std::string number_text(double v) {
    std::ostringstream text;
    text << v;
    return text.str();
}

/// Text such as "from 0 to 1", or "of at least 0" where `most` is 1e30, which stands for no limit.
inline std::string range_text(double least, double most) {
    std::ostringstream text;
    if (most < 1e30)
        text << "from " << least << " to " << most;
    else
        text << "of at least " << least;
    return text.str();
}

}  // namespace covtrace::gltf
