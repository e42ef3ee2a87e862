/// A directive with a type and parameters, kept until it is built.
#pragma once

#include <string>
#include <string_view>

#include "core/error.h"
#include "pbrt/parameter_list.h"
#include "scene/names.h"

namespace covtrace {

struct Entity {
    std::string type;
    ParameterList parameters;
    SourceLocation where;
    int directive = 0;  ///< running number, orders warnings

    /// Throws an error with the place of the parameter, or of the directive where it is not given.
    [[noreturn]] void refuse(std::string_view parameter, const std::string& text) const {
        throw Error(ErrorKind::scene, parameters.where(parameter, where), text);
    }

    /// The number, `otherwise` where it is not given. Throws where it is not above 0.
    float positive(std::string_view name, float otherwise) {
        const float v = parameters.number(name, otherwise);
        if (!(v > 0)) refuse(name, "parameter " + in_quotes(name) + " must be greater than 0");
        return v;
    }
};

}  // namespace covtrace
