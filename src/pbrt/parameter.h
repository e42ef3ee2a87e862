/// One parameter of a directive, as it stands in the file.
#pragma once

#include <string>
#include <vector>

#include "core/colour_space.h"
#include "core/error.h"

namespace covtrace {

enum class ParameterType {
    floats,
    integer,
    boolean,
    string,
    point2,
    vector2,
    point3,
    vector3,
    normal3,
    rgb,
    blackbody,
    spectrum,
    texture
};

struct Parameter {
    ParameterType type{};
    std::string name;
    SourceLocation where;
    ColourSpace colour_space = ColourSpace::srgb;
    bool looked_up = false;
    /// One of these holds the values; flags are in `integers`, `spectrum` has numbers or strings.
    std::vector<float> numbers;
    std::vector<int> integers;
    std::vector<std::string> strings;
};

}  // namespace covtrace
