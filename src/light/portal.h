/// A rectangle that the light of a sky comes through, and directions drawn through it.
///
/// As in pbrt-v4, after Bitterli, Novák and Jarosz 2015, "Portal-masked environment map sampling"
/// (Computer Graphics Forum 34(4)): directions are numbered by the two angles with the portal's
/// normal that they have along its sides. Seen from any point the portal is a rectangle of these
/// numbers, so that sums over a table of the sky tell what comes through, and directions are drawn
/// by what the table has within the rectangle.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "core/error.h"
#include "core/frame.h"
#include "core/vec.h"

namespace covtrace {

class Portal {
  public:
    using Sky = std::function<Rgb(Vec3)>;  ///< radiance by unit world direction, thread-safe
    /// Tabulates `sky` with `resolution` cells per axis, each the mean over `taps` times `taps`
    /// directions. `corners`, in world space, go around a rectangle (InfiniteLight::portal).
    Portal(const std::array<Vec3, 4>& corners, const Sky& sky, int resolution, int taps,
           const SourceLocation& where);

    /// Whether light that travels against the unit direction w comes to p through the portal.
    bool is_open(Vec3 p, Vec3 w) const;

    /// The portal as it is seen from a point: ranges of the two numbers of directions in [0, 1].
    struct View {
        double x0 = 0, x1 = 0, y0 = 0, y1 = 0;
        double light = 0;  ///< choice_weight of the radiance times solid angle, over the view
    };
    /// Empty for points on the side that no light comes to, and where all that is seen is black.
    std::optional<View> view(Vec3 p) const;
    /// A direction through the view, for u in [0, 1)^2, with density `pdf`.
    Vec3 sample(const View& view, Vec2 u) const;
    /// Density of `sample` per solid angle; 0 outside the view.
    float pdf(const View& view, Vec3 w) const;

    /// Radiance times solid angle, over all directions in which light can come through.
    Rgb fluence() const { return fluence_; }
    float area() const { return length(side_x_) * length(side_y_); }

  private:
    struct Place {
        double x, y;
    };
    Place place(Vec3 local) const;
    Vec3 direction(Place at) const;  ///< local, unit
    /// Sum of the table over [0, x] x [0, y].
    double sum(double x, double y) const;
    /// Sum over [0, x] of the cells of row j.
    double row_sum(double x, size_t j) const;
    double corner(size_t i, size_t j) const { return sums_[j * (cells_ + 1) + i]; }

    Vec3 corner_, side_x_, side_y_;
    Frame frame_;  ///< z: the way that rays from the lit side take through the portal
    size_t cells_;
    std::vector<double> sums_;  ///< over all cells below and left of each corner of the table
    Rgb fluence_;
};

}  // namespace covtrace
