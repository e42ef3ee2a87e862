/// Private to this folder: the numbers that a value may have, in words.
#pragma once

#include <sstream>
#include <string>

namespace covtrace::gltf {

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
