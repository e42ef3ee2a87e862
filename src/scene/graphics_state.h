/// What AttributeBegin saves: the current transforms at two times, and all that shapes and lights
/// inherit.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "core/transform.h"
#include "scene/material_builder.h"
#include "scene/parameter_list.h"

namespace covtrace {

/// The current transformation matrix at the start and the end of the motion.
using TransformPair = std::array<Transform, 2>;

struct GraphicsState {
    TransformPair ctm;
    std::array<bool, 2> active{true, true};
    float start_time = 0, end_time = 1;
    bool reverse_orientation = false;
    ColourSpace colour_space = ColourSpace::srgb;
    MaterialReference material;
    int area_light = -1;  ///< into SceneDescription::area_lights
    std::string inside_medium, outside_medium;
    /// By the target of the `Attribute` directive.
    std::map<std::string, std::vector<Parameter>> attributes{
        {"shape", {}}, {"light", {}}, {"material", {}}, {"medium", {}}, {"texture", {}}};

    AnimatedTransform object_to_world() const { return {ctm[0], start_time, ctm[1], end_time}; }
    AnimatedTransform world_to_object() const {
        return {ctm[0].inverse(), start_time, ctm[1].inverse(), end_time};
    }
    /// Multiplies the active transforms from the right.
    /// Errors: Error(scene) where numbers get too large for single precision.
    void concatenate(const Transform& t, const SourceLocation& where);
    void replace(const Transform& t);
};

/// Of 16 numbers, columns first. Errors: Error(scene) where the matrix is singular or not affine.
Transform checked_matrix(const std::array<double, 16>& columns, const SourceLocation& where);
/// Errors: Error(scene) for a factor of zero, a zero axis, degenerate vectors.
Transform checked_scale(double x, double y, double z, const SourceLocation& where);
Transform checked_rotation(double degrees, Vec3 axis, const SourceLocation& where);
Transform checked_look_at(Vec3 eye, Vec3 look, Vec3 up, const SourceLocation& where);

}  // namespace covtrace
