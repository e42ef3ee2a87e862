/// The parameters of one directive: typed access by name, and a record of the names that were asked
/// for.
///
/// As in pbrt, the last of several parameters of one name counts, and a directive's own parameters
/// come before those of an earlier `Attribute`. A parameter of the directive's own with the wrong
/// type is an error; one that nobody asked for becomes a warning.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/vec.h"
#include "pbrt/inherited_parameters.h"
#include "pbrt/parameter.h"

namespace covtrace {

class WarningLog;

class ParameterList {
  public:
    ParameterList() = default;
    /// Makes a list of a directive's own parameters and of `inherited` ones, those of the
    /// `Attribute` directives in force.
    ParameterList(std::vector<Parameter> own, InheritedParameters inherited);

    /// The parameter of that name which counts, marked as looked up; null where there is none.
    /// Inherited ones of other types than `types` are passed over. Errors: Error(scene) where the
    /// directive's own is of such a type.
    const Parameter* find(std::string_view name, std::initializer_list<ParameterType> types);
    bool has(std::string_view name) const;

    float number(std::string_view name, float otherwise);
    std::optional<float> number(std::string_view name);
    int integer(std::string_view name, int otherwise);
    bool flag(std::string_view name, bool otherwise);
    std::string text(std::string_view name, std::string otherwise = {});
    /// The value of a point3, vector3 or normal3.
    Vec3 triple(std::string_view name, Vec3 otherwise);

    std::vector<float> numbers(std::string_view name);
    std::vector<int> integers(std::string_view name);
    std::vector<std::string> texts(std::string_view name);
    std::vector<Vec2> pairs(std::string_view name);    ///< point2 or vector2
    std::vector<Vec3> triples(std::string_view name);  ///< point3, vector3 or normal3

    /// The place of a parameter in its file; `otherwise` where it isn't given.
    SourceLocation where(std::string_view name, const SourceLocation& otherwise) const;
    /// Marks parameters that have no effect on the result, so that nothing is said about them.
    void ignore(std::initializer_list<std::string_view> names);
    void ignore_all();
    /// Warns of each parameter that nobody looked up, and of those given twice.
    void warn_unused(WarningLog& log, const std::string& owner) const;

  private:
    /// The parameter of that name that counts, whatever its type.
    const Parameter* last(std::string_view name) const;
    std::vector<Parameter> own_;  ///< the last one of a name counts
    InheritedParameters inherited_;
};

/// The single colour of an `rgb` parameter in linear Rec.709, as given (negative components are
/// refused).
Rgb rgb_value(const Parameter& p);

}  // namespace covtrace
