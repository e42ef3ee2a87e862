/// Makes camera, film, filter, sampler and integrator of their directives, with pbrt-v4's defaults.
#pragma once

#include "core/colour_space.h"
#include "pbrt/build_context.h"

namespace covtrace {

/// Entities that stand before WorldBegin; the last directive of each kind counts.
struct ViewEntities {
    Entity camera{"perspective", {}, {}, 0};
    Entity film{"rgb", {}, {}, 0};
    Entity filter{"gaussian", {}, {}, 0};
    Entity sampler{"zsobol", {}, {}, 0};
    Entity integrator{"volpath", {}, {}, 0};
    Entity accelerator{"bvh", {}, {}, 0};
    AnimatedTransform camera_to_world;
    std::string camera_medium;  ///< empty: none
    ColourSpace film_colour_space = ColourSpace::srgb;
};

/// Fills the scene's view. Errors: Error(scene) for values out of range, Error(limit) for huge
/// images.
void build_view(ViewEntities& entities, BuildContext& context);

}  // namespace covtrace
