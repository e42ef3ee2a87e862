#include "scene/lens_description.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace covtrace {

namespace {

/// A ray next to the axis: its height, and its slope times the index of refraction.
struct ParaxialRay {
    double height = 0, slope = 0;
};

/// Calls visit(i, height) at each surface for a ray that arrives as `ray`; returns it as it leaves.
template <typename Visit>
ParaxialRay follow(const std::vector<LensSurface>& surfaces, ParaxialRay ray, const Visit& visit) {
    double index = 1;
    for (size_t i = 0; i < surfaces.size(); ++i) {
        const LensSurface& s = surfaces[i];
        visit(i, ray.height);
        if (s.curvature_radius == 0)
            ray.slope *= double(s.index) / index;  // a stop lets rays go straight on
        else
            ray.slope -= ray.height * (double(s.index) - index) / double(s.curvature_radius);
        index = s.index;
        if (i + 1 < surfaces.size()) ray.height += s.thickness * ray.slope / index;
    }
    return ray;
}

}  // namespace

std::optional<size_t> aperture_stop(const std::vector<LensSurface>& surfaces) {
    const auto flat = std::find_if(surfaces.begin(), surfaces.end(),
                                   [](const LensSurface& s) { return s.curvature_radius == 0; });
    if (flat == surfaces.end()) return std::nullopt;
    return size_t(flat - surfaces.begin());
}

ParaxialLens paraxial_lens(const std::vector<LensSurface>& surfaces) {
    ParaxialLens lens;
    lens.widest_pupil = std::numeric_limits<double>::infinity();
    const std::optional<size_t> stop = aperture_stop(surfaces);
    const auto meet = [&](size_t i, double height) {
        if (i == stop) lens.stop_per_pupil = height;
        lens.widest_pupil =
            std::min(lens.widest_pupil, surfaces[i].aperture_radius / std::abs(height));
        if (i + 1 < surfaces.size()) lens.length += surfaces[i].thickness;
    };
    // The two columns of the lens' matrix: a parallel ray, and one from the first vertex.
    const ParaxialRay parallel = follow(surfaces, {1, 0}, meet);
    const ParaxialRay inclined = follow(surfaces, {0, 1}, [](size_t, double) {});
    lens.focal_length = -1 / parallel.slope;
    lens.rear_principal_plane = (1 - parallel.height) / parallel.slope;
    lens.front_principal_plane = (inclined.slope - 1) / parallel.slope;
    return lens;
}

std::optional<double> ParaxialLens::image_distance(double focus_distance) const {
    // Gauss' formula, 1/s + 1/s' = 1/f, where s + s' is the way from film to object but for what
    // lies between the principal planes
    const double between = length - front_principal_plane + rear_principal_plane;
    const double way = focus_distance - between;
    if (!(way > 4 * focal_length)) return std::nullopt;
    return (way - std::sqrt(way * (way - 4 * focal_length))) / 2;
}

double ParaxialLens::nearest_focus() const {
    return length - front_principal_plane + rear_principal_plane + 4 * focal_length;
}

}  // namespace covtrace
