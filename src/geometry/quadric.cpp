#include "geometry/quadric.h"

#include <algorithm>
#include <cmath>

#include "core/frame.h"

namespace covtrace {

namespace {

constexpr double kTwoPi = 6.283185307179586;

double clamped_phi(float degrees) {
    return std::clamp(double(degrees), 0.0, 360.0) * (kTwoPi / 360);
}

Quadric placed(const Transform& local_from_object, bool reverse) {
    Quadric q;
    q.local_from_object = Affine::from_matrix(local_from_object.matrix());
    q.object_from_local = Affine::from_matrix(local_from_object.inverse_matrix());
    q.reverse = reverse;
    return q;
}

double azimuth(Vec3d p) {
    const double phi = std::atan2(p.y, p.x);
    return phi < 0 ? phi + kTwoPi : phi;
}

double polar_angle(const Quadric& q, double z) {
    return std::acos(std::clamp(z / q.radius, -1.0, 1.0));
}

/// Whether a point of the whole sphere or plane belongs to the part that is there.
bool inside_part(const Quadric& q, Vec3d p) {
    if (q.kind == Quadric::Kind::sphere) {
        if (q.z_min > -q.radius && p.z < q.z_min) return false;
        if (q.z_max < q.radius && p.z > q.z_max) return false;
    } else {
        const double r2 = p.x * p.x + p.y * p.y;
        if (r2 > q.radius * q.radius || r2 < q.inner_radius * q.inner_radius) return false;
    }
    return q.phi_max >= kTwoPi || azimuth(p) <= q.phi_max;
}

/// The closest point of the whole surface to a local point, in object space. It is kept off the
/// axis, where azimuth and tangents would be lost.
Vec3d project(const Quadric& q, Vec3d near_local) {
    Vec3d p = q.object_from_local.point(near_local);
    const double tiny = 1e-5 * q.radius;
    if (q.kind == Quadric::Kind::disk) {
        if (p.x == 0 && p.y == 0) p.x = tiny;
        return {p.x, p.y, q.height};
    }
    const double l = length(p);
    p = l > 0 ? p * (q.radius / l) : Vec3d{0, 0, q.radius};
    if (p.x == 0 && p.y == 0) p.x = tiny;
    return p;
}

struct Parameters {
    Vec2 uv;
    Vec3d dpdu, dpdv;
};

Parameters parameters(const Quadric& q, Vec3d p) {
    Parameters s;
    const double rho = std::sqrt(p.x * p.x + p.y * p.y), cos_phi = p.x / rho, sin_phi = p.y / rho;
    s.uv.x = static_cast<float>(std::min(1.0, azimuth(p) / q.phi_max));
    s.dpdu = {-q.phi_max * p.y, q.phi_max * p.x, 0};
    if (q.kind == Quadric::Kind::sphere) {
        const double start = polar_angle(q, q.z_min), range = polar_angle(q, q.z_max) - start;
        s.uv.y = static_cast<float>((polar_angle(q, p.z) - start) / range);
        s.dpdv = Vec3d{p.z * cos_phi, p.z * sin_phi, -rho} * range;
    } else {
        const double width = q.radius - q.inner_radius;
        s.uv.y = static_cast<float>((q.radius - rho) / width);
        s.dpdv = Vec3d{-cos_phi, -sin_phi, 0} * width;
    }
    return s;
}

Vec3d object_normal(const Quadric& q, Vec3d p) {
    const Vec3d n = q.kind == Quadric::Kind::sphere ? p * (1 / q.radius) : Vec3d{0, 0, 1};
    return q.reverse ? n * -1.0 : n;
}

}  // namespace

Quadric make_quadric(const Sphere& sphere, const Transform& local_from_object, bool reverse) {
    Quadric q = placed(local_from_object, reverse);
    q.kind = Quadric::Kind::sphere;
    q.radius = sphere.radius;
    const double lo = std::min(sphere.z_min, sphere.z_max),
                 hi = std::max(sphere.z_min, sphere.z_max);
    q.z_min = std::clamp(lo, -q.radius, q.radius);
    q.z_max = std::clamp(hi, -q.radius, q.radius);
    q.phi_max = clamped_phi(sphere.phi_max);
    return q;
}

Quadric make_quadric(const Disk& disk, const Transform& local_from_object, bool reverse) {
    Quadric q = placed(local_from_object, reverse);
    q.kind = Quadric::Kind::disk;
    q.radius = disk.radius;
    q.height = disk.height;
    q.inner_radius = disk.inner_radius;
    q.phi_max = clamped_phi(disk.phi_max);
    return q;
}

bool intersect_quadric(const Quadric& q, Vec3d origin, Vec3d direction, double t_min, double t_max,
                       double& t) {
    const Vec3d o = q.object_from_local.point(origin), d = q.object_from_local.vector(direction);
    const auto accept = [&](double candidate) {
        if (!(candidate > t_min && candidate < t_max) || !inside_part(q, o + d * candidate))
            return false;
        t = candidate;
        return true;
    };
    if (q.kind == Quadric::Kind::disk) return d.z != 0 && accept((q.height - o.z) / d.z);
    // Intersect from the point of the ray closest to the centre, which loses no digits far away.
    const double a = dot(d, d), middle = -dot(o, d) / a;
    const Vec3d closest = o + d * middle;
    const double h2 = q.radius * q.radius - dot(closest, closest);
    if (!(h2 >= 0)) return false;
    const double half = std::sqrt(h2 / a);
    return accept(middle - half) || accept(middle + half);
}

Bounds3 quadric_bounds(const Quadric& q) {
    const bool sphere = q.kind == Quadric::Kind::sphere;
    const double lo = sphere ? q.z_min : q.height, hi = sphere ? q.z_max : q.height;
    const Affine& m = q.local_from_object;
    const Vec3d center = m.point({0, 0, 0.5 * (lo + hi)});
    double half[3], whole[3];
    for (int i = 0; i < 3; ++i) {
        const double across = q.radius * std::hypot(m.row[i].x, m.row[i].y);
        half[i] = across + std::abs(m.row[i].z) * 0.5 * (hi - lo);
        whole[i] = sphere ? q.radius * length(m.row[i]) : half[i];
    }
    const Vec3d h{half[0], half[1], half[2]}, w{whole[0], whole[1], whole[2]};
    const Vec3d middle = sphere ? m.translation : center;
    Bounds3 box;
    box.lo = max((center - h).to_float(), (middle - w).to_float());
    box.hi = min((center + h).to_float(), (middle + w).to_float());
    for (int i = 0; i < 3; ++i) {
        const float pad = 4e-7f * std::max(std::abs(box.lo[i]), std::abs(box.hi[i]));
        box.lo[i] -= pad;
        box.hi[i] += pad;
    }
    return box;
}

Vec3d quadric_object_point(const Quadric& q, double u, double v) {
    const double phi = u * q.phi_max;
    double rho = q.radius - v * (q.radius - q.inner_radius), z = q.height;
    if (q.kind == Quadric::Kind::sphere) {
        const double start = polar_angle(q, q.z_min);
        const double theta = start + v * (polar_angle(q, q.z_max) - start);
        rho = q.radius * std::sin(theta);
        z = q.radius * std::cos(theta);
    }
    return {rho * std::cos(phi), rho * std::sin(phi), z};
}

SurfacePoint quadric_point(const Quadric& q, Vec3d near) {
    const Vec3d p = project(q, near);
    const Parameters s = parameters(q, p);
    SurfacePoint point;
    point.position = q.local_from_object.point(p);
    point.ng = normalize(q.object_from_local.transposed(object_normal(q, p)));
    point.ns = point.ng;
    point.dpdu = q.local_from_object.vector(s.dpdu);
    point.dpdv = q.local_from_object.vector(s.dpdv);
    point.uv = s.uv;
    return point;
}

SurfaceDerivatives quadric_derivatives(const Quadric& q, Vec3d near) {
    const Vec3d p = project(q, near);
    const Parameters s = parameters(q, p);
    const Vec3d n = object_normal(q, p);
    // Derivatives are along an orthonormal tangent pair of object space: (u, v) has poles, the
    // surface has none.
    const Frame frame = Frame::from_z(n.to_float());
    const Vec3d a(frame.x), b(frame.y);
    SurfaceDerivatives d;
    d.dpda = q.local_from_object.vector(a);
    d.dpdb = q.local_from_object.vector(b);
    const auto uv_along = [&s](Vec3d tangent) {
        return Vec2{static_cast<float>(dot(tangent, s.dpdu) / dot(s.dpdu, s.dpdu)),
                    static_cast<float>(dot(tangent, s.dpdv) / dot(s.dpdv, s.dpdv))};
    };
    d.duvda = uv_along(a);
    d.duvdb = uv_along(b);
    d.n = q.object_from_local.transposed(n);
    if (q.kind == Quadric::Kind::sphere) {
        const double curvature = (q.reverse ? -1 : 1) / q.radius;
        d.dnda = q.object_from_local.transposed(a * curvature);
        d.dndb = q.object_from_local.transposed(b * curvature);
    }
    return d;
}

}  // namespace covtrace
