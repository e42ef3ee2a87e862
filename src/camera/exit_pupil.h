/// Where in the plane behind a lens light comes to the film from.
#pragma once

#include <array>
#include <vector>

#include "camera/lens_system.h"
#include "core/vec.h"

namespace covtrace {

/// The exit pupils of a lens, as pbrt-v4 bounds them: by the distance of the place on the film from
/// the axis, which is turned onto the x axis. A box would waste the samples in its corners, so each
/// pupil is bounded row by row; light that a bound leaves beside the pupil is blocked by the lens.
class ExitPupils {
  public:
    /// Finds the pupils for places up to `film_radius` from the axis.
    ExitPupils(const LensSystem& lens, float film_radius);

    struct Sample {
        Vec2 rear;       ///< place in the plane of the rear vertex
        float area = 0;  ///< of all places sampled; 0 where no light gets to this place of the film
    };
    /// Samples the plane evenly within the bounds of the pupil seen from a place on the film.
    Sample sample(Vec2 film, Vec2 u) const;

  private:
    static constexpr int kRows = 32;
    struct Pupil {
        float y0 = 0, row_height = 0;
        std::array<float, kRows> x0{}, width{};
        float total_width = 0;
    };
    /// Box in the plane of the rear vertex, from -y to y.
    struct Box {
        float x0 = 0, x1 = 0, y = 0;
    };
    /// The radii at which the pupils of a range of film radii are looked at.
    using Radii = std::array<float, 3>;
    static Box shrunk(const LensSystem& lens, const Radii& film, const Box& box, float stop);
    static Pupil find(const LensSystem& lens, const Radii& film);

    std::vector<Pupil> pupils_;  // for equal ranges of film radii
    float film_radius_ = 0;
};

}  // namespace covtrace
