#include "scene/framing.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>

#include "scene/extent.h"
#include "scene/up_axis.h"
#include "scene/view_text.h"

namespace covtrace {

namespace {

constexpr float kFov = 40, kDegrees = 180 / kPi;
constexpr double kFilled = 0.9;  // share of the picture's width or height that the shapes take

/// The dot product in double precision, for scenes far from the origin.
double along(Vec3 p, Vec3 axis) {
    return double(p.x) * double(axis.x) + double(p.y) * double(axis.y) +
           double(p.z) * double(axis.z);
}

/// Extent of points in front of a camera of which only the position is open: for a pair of opposite
/// sides of its pyramid of view, how far points reach beyond planes through the origin.
class Slab {
  public:
    /// `slope`: tangent of the angle between the axis of view and the sides.
    explicit Slab(double slope) : slope_(slope) {}

    void add(double across, double depth) {
        high_ = std::max(high_, across - slope_ * depth);
        low_ = std::max(low_, -across - slope_ * depth);
    }
    double middle() const { return (high_ - low_) / 2; }
    /// The place nearest to `place` from which, at `depth`, both sides hold all points.
    double held(double place, double depth) const {
        const double reach = slope_ * depth;
        return std::clamp(place, std::min(middle(), high_ + reach),
                          std::max(middle(), -low_ - reach));
    }
    /// The largest depth from which both sides hold all points.
    double depth() const { return -(high_ + low_) / (2 * slope_); }

  private:
    double slope_;
    double high_ = -kInfinity, low_ = -kInfinity;
};

/// Share of a picture that points fill along one of its sides, from a place of the camera. The
/// margins at its ends are to be equal in the picture, not in space: what is further away takes
/// less of it.
class Filled {
  public:
    explicit Filled(double place) : place_(place) {}

    void add(double across, double ahead) {
        const double where = (across - place_) / ahead;
        if (where > highest_.where) highest_ = {where, across, ahead};
        if (where < lowest_.where) lowest_ = {where, across, ahead};
    }
    /// Where the points that are now at both ends are as far from the middle of the picture.
    double middle() const {
        return (highest_.across * lowest_.ahead + lowest_.across * highest_.ahead) /
               (highest_.ahead + lowest_.ahead);
    }

  private:
    struct End {
        double where, across = 0, ahead = 1;
    };
    double place_;
    End highest_{-kInfinity}, lowest_{kInfinity};
};

/// Other points come to the ends where the camera moves to a middle: few times, as the function of
/// the place whose root is looked for is nearly straight.
constexpr int kRounds = 4;

}  // namespace

bool frame_all(SceneDescription& scene) {
    const float azimuth = 30 / kDegrees, height = 20 / kDegrees;
    const Vec3 top = up_axis(scene), front = top.z != 0 ? Vec3{0, -1, 0} : Vec3{0, 0, 1};
    const Vec3 forward = -(cross(top, front) * (std::sin(azimuth) * std::cos(height)) +
                           top * std::sin(height) + front * (std::cos(azimuth) * std::cos(height)));
    const Vec3 right = normalize(cross(forward, top)), up = cross(right, forward);
    const double aspect = double(scene.film.width) / double(scene.film.height);
    const double slope = kFilled * std::tan(0.5 * double(kFov / kDegrees));
    Slab across(slope * std::max(1.0, aspect)), upright(slope * std::max(1.0, 1 / aspect));
    Bounds3 box;
    double nearest = kInfinity;
    const auto add = [&](Vec3 p) {
        const double depth = along(p, forward);
        across.add(along(p, right), depth);
        upright.add(along(p, up), depth);
        nearest = std::min(nearest, depth);
        box.extend(p);
    };
    visit_points(scene, add);
    if (box.empty())
        for (const float x : {-1.0f, 1.0f}) add({x, x, x});

    // A point has no extent: it is seen from a little before it
    const double before = nearest - 1e-3 * std::max(double(box.radius()), 1e-3);
    const double depth = std::min({across.depth(), upright.depth(), before});
    double x = across.middle(), y = upright.middle();
    for (int round = 0; round < kRounds && !box.empty(); ++round) {
        Filled along_x(x), along_y(y);
        visit_points(scene, [&](Vec3 p) {
            const double ahead = along(p, forward) - depth;
            along_x.add(along(p, right), ahead);
            along_y.add(along(p, up), ahead);
        });
        x = across.held(along_x.middle(), depth);
        y = upright.held(along_y.middle(), depth);
    }
    Matrix4 m;
    Vec3 eye;
    for (int row = 0; row < 3; ++row) {
        const double axes[] = {double(right[row]), double(up[row]), double(forward[row])};
        const double place = axes[0] * x + axes[1] * y + axes[2] * depth;
        for (size_t column = 0; column < 3; ++column)
            m.m[static_cast<size_t>(row)][column] = axes[column];
        m.m[static_cast<size_t>(row)][3] = place;
        eye[row] = static_cast<float>(place);
    }
    const auto to_world = Transform::from_matrix(m);
    const auto focus = static_cast<float>(along(box.center(), forward) - depth);
    if (!to_world || !is_finite(eye) || !std::isfinite(focus)) return false;
    scene.camera.camera_to_world = AnimatedTransform(*to_world);
    scene.camera.fov = kFov;
    scene.camera.focal_distance = focus;
    return true;
}

std::string view_of_all(SceneDescription& scene) {
    if (bounds(scene).empty()) return {};
    const Vec3 up = up_axis(scene);
    const std::optional<Vec3> own_up = std::exchange(scene.up, up);
    CameraDescription own = std::exchange(scene.camera, {});
    std::string text = frame_all(scene) ? view_text(scene) : "";
    // A camera of the command line takes its upward direction with it
    if (!text.empty() && !scene.camera_override.empty()) {
        std::ostringstream out;
        out << " up " << up.x << ',' << up.y << ',' << up.z;
        text += out.str();
    }
    scene.camera = std::move(own);
    scene.up = own_up;
    return text;
}

bool is_framed(const SceneDescription& scene) {
    // A camera that a format itself puts in place of a missing one has no place in the file
    return scene.no_camera && scene.camera.where.file;
}

}  // namespace covtrace
