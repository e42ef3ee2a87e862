/// Light that is sampled through panes (pane.h).
///
/// A direction alone says what a way through panes finds, so the directions of sampled lights serve
/// for it, too: light is looked for where the refracted way ends, at whichever emitter. Behind
/// parallel faces that is the sampled point but for the shift in the glass. Paths find the same
/// ways by themselves, and the two are weighted by their densities (docs/decisions/0121).
#pragma once

#include "integrator/lit_scene.h"

namespace covtrace {

/// A place that light is sampled for, with all that the densities of its samples depend on.
struct LitPlace {
    Vec3 position;
    Vec3 normal{};  ///< normal that lights are sampled for; 0: both sides
    /// The parts of the sky that are seen from there; null: not known.
    const SkyCell* sky_cell = nullptr;
    LightTree::Factors lamp_factors{};  ///< factors for the choice among lamps
};

/// Density per solid angle with which light sampling finds the direction of a ray from a place, of
/// samples behind panes: it samples the emitters that the ray meets where it goes straight on
/// through the first pane, `to_pane` away, and all others, up to the first other surface. The rays
/// that are traced are added to `rays`.
float density_through_panes(const LitScene& scene, const LitPlace& place, Ray ray, float to_pane,
                            uint64_t& rays);

}  // namespace covtrace
