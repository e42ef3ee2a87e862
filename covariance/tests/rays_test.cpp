// Operators against exact ray geometry: real rays are traced beside the central one, and their
// finite differences compared with the matrices of the operators. No formula of the library is used
// to trace.
#include <functional>

#include "support.h"

namespace support {
namespace {

using namespace covariance;

struct Ray {
    Vec3 origin, direction;
};

using Coordinates = std::array<double, 4>;

/// The neighbour (x, y, u, v) of the ray through `centre` with the given frame.
Ray neighbour(const Frame& f, const Vec3& centre, const Coordinates& p) {
    return {centre + p[0] * f.x + p[1] * f.y, f.z + p[2] * f.x + p[3] * f.y};
}

/// The coordinates of a ray relative to the one through `centre` along f.z.
Coordinates coordinates(const Frame& f, const Vec3& centre, const Ray& ray) {
    const Vec3 d = (1 / dot(ray.direction, f.z)) * ray.direction;
    const Vec3 o = ray.origin - centre;
    const Vec3 at = o - dot(o, f.z) * d;
    return {dot(at, f.x), dot(at, f.y), dot(d, f.x), dot(d, f.y)};
}

/// Jacobian d(old)/d(new) by central differences, as the space and angle part of a 5x5.
Dense jacobian(const std::function<Coordinates(const Coordinates&)>& old_from_new) {
    Dense a = Dense::identity();
    const double step = 1e-5;
    for (std::size_t j = 0; j < 4; ++j) {
        Coordinates plus{}, minus{};
        plus[j] = step, minus[j] = -step;
        const Coordinates p = old_from_new(plus), m = old_from_new(minus);
        for (std::size_t i = 0; i < 4; ++i) a(i, j) = (p[i] - m[i]) / (2 * step);
    }
    return a;
}

void expect_near(const Dense& a, const Dense& b, double tolerance) {
    for (std::size_t i = 0; i < 5; ++i)
        for (std::size_t j = 0; j < 5; ++j)
            EXPECT_NEAR(a(i, j), b(i, j), tolerance) << i << ", " << j;
}

Vec3 unit(const Vec3& v) {
    return normalized_or(v, Vec3{0, 0, 1});
}

Vec3 refracted(const Vec3& d, const Vec3& n, double n1, double n2) {
    const double eta = n1 / n2, c1 = -dot(d, n), c2 = std::sqrt(1 - eta * eta * (1 - c1 * c1));
    return eta * d + (eta * c1 - c2) * n;
}

Vec3 reflected(const Vec3& d, const Vec3& n) {
    return d - 2 * dot(d, n) * n;
}

/// The point where a ray meets the sphere of radius 1/k that touches the plane z = 0 at the origin
/// from below.
Vec3 hit_sphere(const Ray& ray, double k) {
    const double radius = 1 / k;
    const Vec3 centre{0, 0, -radius}, o = ray.origin - centre, d = unit(ray.direction);
    const double b = dot(o, d), c = dot(o, o) - radius * radius, root = std::sqrt(b * b - c);
    return ray.origin + (radius > 0 ? -b - root : -b + root) * d;
}

/// Events at a sphere by reversibility: light that leaves is traced back to the light that arrived,
/// with both reversed.
class SphereEvent : public testing::TestWithParam<double> {
  protected:
    Surface surface() const {
        const Frame basis = frame_along<double>({0, 0, 1});
        const double a = 0.4, c = std::cos(a), s = std::sin(a), k = GetParam();
        return {{0, 0, 1}, c * basis.x + s * basis.y, c * basis.y - s * basis.x, {k, 0, k}};
    }
    Frame incoming() const {
        const Frame f = frame_along<double>(unit(Vec3{0.5, -0.3, -0.7}));
        return rotate(Field{{}, f}, 0.8).frame;
    }
    Vec3 normal_at(const Vec3& p) const {
        const double k = GetParam();
        return k > 0 ? unit(p + Vec3{0, 0, 1 / k}) : -unit(p + Vec3{0, 0, 1 / k});
    }
    Dense exact(const Frame& in, const Frame& out,
                const std::function<Vec3(const Vec3& direction, const Vec3& normal)>& bend) const {
        return jacobian([&](const Coordinates& p) {
            const Ray leaving = neighbour(out, {}, p);
            // The start is on the side where the light goes: step out along it, come back to the
            // sphere.
            const Ray reversed{leaving.origin + 0.4 * unit(leaving.direction), -leaving.direction};
            const bool outside = dot(leaving.direction, Vec3{0, 0, 1}) > 0;
            const Vec3 at = outside ? hit_sphere(reversed, GetParam()) : far_hit(reversed);
            const Vec3 arriving = -bend(-unit(leaving.direction), normal_at(at));
            return coordinates(in, {}, {at, arriving});
        });
    }

  private:
    /// The hit from inside: the other root of the quadratic.
    Vec3 far_hit(const Ray& ray) const {
        const double radius = 1 / GetParam();
        const Vec3 centre{0, 0, -radius}, o = ray.origin - centre, d = unit(ray.direction);
        const double b = dot(o, d), c = dot(o, o) - radius * radius;
        const double root = std::sqrt(b * b - c);
        return ray.origin + (radius > 0 ? -b + root : -b - root) * d;
    }
};

TEST_P(SphereEvent, MirrorEqualsExactRays) {
    const Frame in = incoming();
    const Vec3 leaving = reflected(in.z, {0, 0, 1});
    const Frame out = mirrored(in, half_vector(in.z, leaving, Vec3{0, 0, 1}));
    const Dense ours = surface_enter_matrix(in, surface()) * surface_exit_matrix(out, surface());
    expect_near(ours, exact(in, out, reflected), 1e-8);
}

TEST_P(SphereEvent, RefractionEqualsExactRays) {
    const Frame in = incoming();
    const Vec3 leaving = refracted(in.z, {0, 0, 1}, 1.0, 1.5);
    const Frame out = turned_to(in, leaving);
    const Dense ours = surface_enter_matrix(in, surface()) *
                       angular_map_matrix(specular_map(in, out, surface(), 1.0, 1.5)) *
                       surface_exit_matrix(out, surface());
    // Backwards the light comes out of the denser medium, against the other side of the normal.
    const auto bend = [](const Vec3& d, const Vec3& n) { return refracted(d, -n, 1.5, 1.0); };
    expect_near(ours, exact(in, out, bend), 1e-8);
}

INSTANTIATE_TEST_SUITE_P(Curvatures, SphereEvent, testing::Values(0.7, -0.4, 0.05));

TEST(RoughRefraction, MapsSlopesLikeTheMicrofacetThatTakesPart) {
    const Frame in = frame_along<double>(unit(Vec3{0.5, -0.3, -0.7}));
    const Vec3 facet_normal = unit(Vec3{0.15, 0.2, 1});  // not the surface's normal
    const Vec3 leaving = refracted(in.z, facet_normal, 1.0, 1.5);
    const Surface hit{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {}};
    const Field field{Matrix::diagonal(1, 2, 3, 4, 5), in};
    // With an infinitely sharp lobe only the map remains.
    const Field out = refract_glossy(field, hit, leaving, 1.0, 1.5, Sym2::diagonal(1e16, 1e16));
    const Dense exact = jacobian([&](const Coordinates& p) {
        const Vec3 d = unit(neighbour(out.frame, {}, p).direction);
        const Vec3 arriving = -refracted(-d, -facet_normal, 1.5, 1.0);
        const Coordinates c = coordinates(in, {}, {Vec3{}, arriving});
        return Coordinates{p[0], p[1], c[2], c[3]};
    });
    EXPECT_LT(distance(out.sigma, transform(field.sigma, exact)), 1e-8);
}

// ---- cameras: the rays of neighbouring pixels and lens points against the sensor matrices

using CameraRay = std::function<Ray(const Coordinates& pixel_and_lens)>;

/// The sensor matrix by finite differences: a ray of the camera, reversed, as light that arrives.
Dense exact_sensor(const Frame& f, const CameraRay& camera) {
    const Vec3 centre = camera({}).origin;
    return jacobian([&](const Coordinates& p) {
        const Ray ray = camera(p);
        return coordinates(f, centre, {ray.origin, -ray.direction});
    });
}

struct View {
    Vec3 e1, e2, e3;
};

View tilted_view() {
    const Frame f = frame_along<double>(unit(Vec3{0.2, 0.4, -0.9}));
    return {f.x, -f.y, f.z};
}

TEST(Cameras, ThinLensEqualsExactRays) {
    const View v = tilted_view();
    const ThinLens<double> camera{v.e1, v.e2, v.e3, 2.5, 0.2, 80, 60, 0.3};
    const CameraRay trace = [&](const Coordinates& p) {
        const double px = 0.3 + p[0] / 80, py = -0.2 + p[1] / 60;
        const double l1 = 0.2 * (0.4 + p[2]), l2 = 0.2 * (-0.3 + p[3]);
        return Ray{l1 * v.e1 + l2 * v.e2, v.e3 + (px - l1 / 2.5) * v.e1 + (py - l2 / 2.5) * v.e2};
    };
    const Frame f = frame_along<double>(-unit(trace({}).direction));
    Dense exact = exact_sensor(f, trace);
    exact(4, 4) = 0.3;
    expect_near(sensor_matrix(f, camera), exact, 1e-8);

    // The general camera, from the derivatives of the same rays.
    CameraDerivatives<double> derivatives{.shutter = 0.3};
    for (std::size_t k = 0; k < 4; ++k) {
        Coordinates plus{}, minus{};
        plus[k] = 1e-5, minus[k] = -1e-5;
        const Ray a = trace(plus), b = trace(minus);
        derivatives.origin[k] = 5e4 * (a.origin - b.origin);
        derivatives.direction[k] = 5e4 * (unit(a.direction) - unit(b.direction));
    }
    expect_near(sensor_matrix(f, derivatives), exact, 1e-8);
}

TEST(Cameras, OrthographicEqualsExactRays) {
    const View v = tilted_view();
    const OrthographicLens<double> camera{v.e1, v.e2, v.e3, 2.5, 0.2, 80, 60, 0.3};
    const CameraRay trace = [&](const Coordinates& p) {
        const double l1 = 0.2 * (0.4 + p[2]), l2 = 0.2 * (-0.3 + p[3]);
        return Ray{(p[0] / 80 + l1) * v.e1 + (p[1] / 60 + l2) * v.e2,
                   v.e3 - (l1 / 2.5) * v.e1 - (l2 / 2.5) * v.e2};
    };
    const Frame f = frame_along<double>(-unit(trace({}).direction));
    Dense exact = exact_sensor(f, trace);
    exact(4, 4) = 0.3;
    expect_near(sensor_matrix(f, camera), exact, 1e-8);
}

}  // namespace
}  // namespace support
