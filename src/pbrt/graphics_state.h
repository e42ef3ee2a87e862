/// The state that AttributeBegin saves: the current transforms at two times, and all that shapes
/// and lights inherit.
#pragma once

#include <array>
#include <map>
#include <string>

#include "pbrt/current_transform.h"
#include "pbrt/material_builder.h"
#include "pbrt/parameter_list.h"

namespace covtrace {

/// The current transformation matrix at the start and the end of the motion.
using TransformPair = std::array<CurrentTransform, 2>;

struct GraphicsState {
    TransformPair ctm;
    std::array<bool, 2> active{true, true};
    float start_time = 0, end_time = 1;
    bool reverse_orientation = false;
    ColourSpace colour_space = ColourSpace::srgb;
    MaterialReference material;
    int area_light = -1;  ///< into SceneDescription::area_lights
    std::string inside_medium, outside_medium;
    /// Parameters of `Attribute` directives, by their target.
    std::map<std::string, InheritedParameters> attributes{
        {"shape", {}}, {"light", {}}, {"material", {}}, {"medium", {}}, {"texture", {}}};

    /// The transform of an entity that stands at `user`. Errors: Error(scene) where the current
    /// matrix places nothing.
    AnimatedTransform object_to_world(const SourceLocation& user) const;
    AnimatedTransform world_to_object(const SourceLocation& user) const;
    /// Multiplies the active transforms from the right; `where` is the directive that asks for it.
    void concatenate(const CurrentTransform& t, const SourceLocation& where);
    void replace(const CurrentTransform& t);
};

}  // namespace covtrace
