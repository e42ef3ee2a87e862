#include "camera/lens_system.h"

#include <cmath>
#include <sstream>

namespace covtrace {

namespace {

/// Distance along a ray from the plane z = 0 of a sphere's vertex to the sphere, whose centre is
/// `radius` behind the vertex; of both points the one beside the vertex. None where it is missed.
std::optional<float> to_sphere(Vec3 at_vertex, Vec3 direction, float radius) {
    const float b = dot(at_vertex, direction) + radius * direction.z;
    const float c = at_vertex.x * at_vertex.x + at_vertex.y * at_vertex.y;
    const float discriminant = b * b - c;
    if (!(discriminant >= 0)) return std::nullopt;
    const float far = b + std::copysign(std::sqrt(discriminant), radius * direction.z);
    return far == 0 ? 0 : -c / far;
}

/// Refracts a direction at a surface of unit normal `n`, which faces the way it came from; none
/// where all is reflected.
std::optional<Vec3> refracted(Vec3 direction, Vec3 n, float index_ratio) {
    const float cosine = -dot(direction, n);
    const float square = 1 - index_ratio * index_ratio * (1 - cosine * cosine);
    if (!(square >= 0)) return std::nullopt;
    return direction * index_ratio + n * (index_ratio * cosine - std::sqrt(square));
}

}  // namespace

LensSystem::LensSystem(const LensDescription& lens, float pupil_radius, float focus_distance,
                       const SourceLocation& where)
    : mask_(lens.aperture) {
    const ParaxialLens paraxial = paraxial_lens(lens.surfaces);
    const std::optional<double> distance = paraxial.image_distance(focus_distance);
    if (!distance) {
        std::ostringstream text;
        text << "the lens does not focus at " << focus_distance << "; expected more than "
             << paraxial.nearest_focus();
        throw Error(ErrorKind::scene, where, text.str());
    }
    image_distance_ = float(*distance);
    rear_z_ = float(*distance + paraxial.rear_principal_plane);
    const std::optional<size_t> stop = aperture_stop(lens.surfaces);
    double z = *distance + paraxial.rear_principal_plane;
    for (size_t i = lens.surfaces.size(); i-- > 0;) {
        const LensSurface& s = lens.surfaces[i];
        if (i + 1 < lens.surfaces.size()) z += double(s.thickness);
        const float index_in_front = i > 0 ? lens.surfaces[i - 1].index : 1.0f;
        surfaces_.push_back(
            {float(z), s.curvature_radius, s.index / index_in_front, s.aperture_radius, i == stop});
    }
    front_z_ = float(z);
    if (stop)
        stop_radius_ = std::min(lens.surfaces[*stop].aperture_radius,
                                float(double(pupil_radius) * paraxial.stop_per_pupil));
}

template <typename Blocks>
std::optional<LensRay> LensSystem::trace(Vec2 film, Vec2 rear, const Blocks& blocks) const {
    LensRay ray;
    Vec3 p{film.x, film.y, 0};
    Vec3 d = normalize(Vec3{rear.x - film.x, rear.y - film.y, rear_z_});
    for (const Surface& s : surfaces_) {
        float t = (s.z - p.z) / d.z;
        Vec3 at{p.x + t * d.x, p.y + t * d.y, 0};
        if (s.curvature_radius != 0) {
            const std::optional<float> on = to_sphere(at, d, s.curvature_radius);
            if (!on) return std::nullopt;
            t += *on;
            at += d * *on;
        }
        if (!(t >= 0) || blocks(s, Vec2{at.x, at.y}, ray)) return std::nullopt;
        p = {at.x, at.y, s.z + at.z};
        if (s.curvature_radius == 0 || s.index_ratio == 1) continue;
        const Vec3 n = Vec3{at.x, at.y, at.z + s.curvature_radius} / s.curvature_radius;
        const std::optional<Vec3> leaves = refracted(d, face_forward(n, -d), s.index_ratio);
        if (!leaves || !(leaves->z > 0)) return std::nullopt;
        d = normalize(*leaves);
    }
    ray.origin = p;
    ray.direction = d;
    return ray;
}

std::optional<LensRay> LensSystem::trace(Vec2 film, Vec2 rear) const {
    return trace(film, rear, [this](const Surface& s, Vec2 at, LensRay& ray) {
        if (!s.is_stop) return !(dot(at, at) <= s.aperture_radius * s.aperture_radius);
        ray.share = mask_(at * (1 / stop_radius_));
        return !(ray.share > 0);
    });
}

std::optional<LensRay> LensSystem::trace_unblocked(Vec2 film, Vec2 rear) const {
    return trace(film, rear, [](const Surface&, Vec2, LensRay&) { return false; });
}

bool LensSystem::passes(Vec2 film, Vec2 rear, float stop_radius) const {
    return trace(film, rear,
                 [stop_radius](const Surface& s, Vec2 at, LensRay&) {
                     const float radius = s.is_stop ? stop_radius : s.aperture_radius;
                     return !(dot(at, at) <= radius * radius);
                 })
        .has_value();
}

}  // namespace covtrace
