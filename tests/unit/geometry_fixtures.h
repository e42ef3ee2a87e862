/// Small scene descriptions for the tests of geometry/.
#pragma once

#include <cmath>
#include <memory>
#include <utility>

#include "core/hash.h"
#include "core/rng.h"
#include "core/warp.h"
#include "geometry/geometry.h"

namespace covtrace::test {

/// Uniform numbers in [0, 1) from a fixed seed.
class Random {
  public:
    explicit Random(uint64_t seed) : state_(seed * 2 + 1) {}
    float next() {
        state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
        return static_cast<float>(state_ >> 40) * 0x1p-24f;
    }
    float between(float a, float b) { return a + (b - a) * next(); }
    Vec3 in_box(float half) {
        const float x = between(-half, half), y = between(-half, half), z = between(-half, half);
        return {x, y, z};
    }
    Vec3 direction() {
        const float z = between(-1, 1), phi = 2 * kPi * next(), r = safe_sqrt(1 - z * z);
        return {r * std::cos(phi), r * std::sin(phi), z};
    }

  private:
    uint64_t state_;
};

template <class G>
ShapeDescription shape(G geometry, const AnimatedTransform& transform = {}) {
    ShapeDescription s;
    s.geometry = std::move(geometry);
    s.object_to_world = transform;
    return s;
}

inline ShapeDescription mesh(TriangleMesh m, const AnimatedTransform& transform = {}) {
    return shape(std::make_shared<const TriangleMesh>(std::move(m)), transform);
}

inline ShapeDescription patches(BilinearMesh m, const AnimatedTransform& transform = {}) {
    return shape(std::make_shared<const BilinearMesh>(std::move(m)), transform);
}

/// One patch with corners p00, p10, p01, p11.
inline BilinearMesh patch(Vec3 p00, Vec3 p10, Vec3 p01, Vec3 p11) {
    BilinearMesh m;
    m.positions = {p00, p10, p01, p11};
    m.patches = {{0, 1, 2, 3}};
    return m;
}

/// The triangle (0,0,0), (1,0,0), (0,1,0), whose cross product points to +z.
inline TriangleMesh unit_triangle() {
    TriangleMesh m;
    m.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    m.triangles = {{0, 1, 2}};
    return m;
}

/// A sphere of triangles with exact vertex normals, outside outwards.
inline TriangleMesh sphere_mesh(float radius, int rings, int sectors) {
    TriangleMesh m;
    for (int i = 0; i <= rings; ++i)
        for (int j = 0; j <= sectors; ++j) {
            const float theta = kPi * float(i) / float(rings),
                        phi = 2 * kPi * float(j) / float(sectors);
            const Vec3 n{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                         std::cos(theta)};
            m.positions.push_back(n * radius);
            m.normals.push_back(n);
            m.uvs.push_back({phi / (2 * kPi), theta / kPi});
        }
    const auto index = [sectors](int i, int j) {
        return static_cast<uint32_t>(i * (sectors + 1) + j);
    };
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < sectors; ++j) {
            if (i > 0) m.triangles.push_back({index(i, j), index(i + 1, j), index(i, j + 1)});
            if (i + 1 < rings)
                m.triangles.push_back({index(i, j + 1), index(i + 1, j), index(i + 1, j + 1)});
        }
    return m;
}

/// A full sphere about the origin.
inline Sphere sphere(float radius) {
    return {radius, -radius, radius, 360};
}

inline SceneDescription scene_of(std::vector<ShapeDescription> shapes) {
    SceneDescription scene;
    scene.shapes = std::move(shapes);
    return scene;
}

inline Transform chain(std::initializer_list<Transform> parts) {
    Transform t;
    for (const Transform& part : parts) t = t * part;
    return t;
}

}  // namespace covtrace::test
