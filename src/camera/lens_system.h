/// A camera's lens, with rays traced through all its surfaces.
///
/// Camera space: the film is the plane z = 0, the scene lies at positive z. Lengths are in scene
/// units.
#pragma once

#include <optional>
#include <vector>

#include "camera/aperture_mask.h"
#include "core/vec.h"
#include "scene/lens_description.h"

namespace covtrace {

/// A ray as it leaves the lens towards the scene.
struct LensRay {
    Vec3 origin, direction;  ///< on the front surface; unit length
    float share = 1;         ///< of its light that the aperture lets through
};

class LensSystem {
  public:
    /// Places the lens so that what lies `focus_distance` in front of the film is sharp on it, and
    /// opens its stop for an entrance pupil of `pupil_radius`. Throws Error(scene) at `where` for
    /// what is too near to be in focus.
    LensSystem(const LensDescription& lens, float pupil_radius, float focus_distance,
               const SourceLocation& where);

    /// The place of the rearmost surface's vertex, and of the foremost one's.
    float rear_z() const { return rear_z_; }
    float front_z() const { return front_z_; }
    /// Distance from the film to the thin lens of the same image.
    float image_distance() const { return image_distance_; }
    float rear_radius() const { return surfaces_.front().aperture_radius; }
    float stop_radius() const { return stop_radius_; }
    /// The stop's radius as far as its mask lets anything through.
    float stop_reach() const { return stop_radius_ * mask_.reach(); }
    bool has_stop() const { return stop_radius_ > 0; }

    /// Traces a ray from a place on the film towards a place in the plane of the rear vertex; none
    /// where a surface is missed, reflects all, or its rim or the aperture blocks the ray.
    std::optional<LensRay> trace(Vec2 film, Vec2 rear) const;
    /// The same with all rims and the aperture wide open.
    std::optional<LensRay> trace_unblocked(Vec2 film, Vec2 rear) const;
    /// Whether a ray passes all rims and a round stop of this radius.
    bool passes(Vec2 film, Vec2 rear, float stop_radius) const;

  private:
    struct Surface {
        float z = 0;  // of the vertex
        float curvature_radius = 0;
        float index_ratio = 1;  // of the film's side over the scene's
        float aperture_radius = 0;
        bool is_stop = false;
    };
    /// Traces a ray; blocks(surface, place) tells where it ends.
    template <typename Blocks>
    std::optional<LensRay> trace(Vec2 film, Vec2 rear, const Blocks& blocks) const;

    std::vector<Surface> surfaces_;  // from the film to the scene
    ApertureMask mask_;
    float stop_radius_ = 0;
    float rear_z_ = 0, front_z_ = 0, image_distance_ = 0;
};

}  // namespace covtrace
