/// Small scenes with lights, for the tests of shading/lights.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "geometry/geometry.h"
#include "image/image.h"
#include "light/spectra.h"

namespace covtrace::test {

/// A description under construction; `build` once it is complete.
class LightScene {
  public:
    SceneDescription description;

    /// Makes the shape emit; returns its index.
    size_t add(ShapeDescription shape, Rgb radiance, bool two_sided = false) {
        shape.area_light = static_cast<int>(description.area_lights.size());
        AreaLightDescription light;
        light.radiance = radiance;
        light.two_sided = two_sided;
        description.area_lights.push_back(light);
        description.shapes.push_back(std::move(shape));
        return description.shapes.size() - 1;
    }
    template <class L>
    void add_light(L light, const Transform& light_to_world = {}) {
        LightDescription d;
        d.value = std::move(light);
        d.light_to_world = light_to_world;
        description.lights.push_back(std::move(d));
    }
    void build() {
        geometry = std::make_unique<Geometry>(description);
        lights = std::make_unique<Lights>(description, *geometry);
    }

    void build_with_spectra() {
        build();
        spectra = std::make_unique<LightSpectra>(*lights);
    }

    std::unique_ptr<Geometry> geometry;
    std::unique_ptr<Lights> lights;
    std::unique_ptr<LightSpectra> spectra;
};

template <class G>
ShapeDescription shape_of(G geometry, const AnimatedTransform& transform = {}) {
    ShapeDescription s;
    s.geometry = std::move(geometry);
    s.object_to_world = transform;
    return s;
}

inline ShapeDescription mesh_of(TriangleMesh m, const AnimatedTransform& transform = {}) {
    return shape_of(std::make_shared<const TriangleMesh>(std::move(m)), transform);
}

/// Two triangles over [-a/2, a/2] x [-b/2, b/2], outside towards +z.
inline TriangleMesh rectangle(float a, float b) {
    TriangleMesh m;
    m.positions = {{-a / 2, -b / 2, 0}, {a / 2, -b / 2, 0}, {a / 2, b / 2, 0}, {-a / 2, b / 2, 0}};
    m.triangles = {{0, 1, 2}, {0, 2, 3}};
    return m;
}

/// A cube of side 2 about the origin, outside outwards.
inline TriangleMesh cube() {
    TriangleMesh m;
    for (int i = 0; i < 8; ++i)
        m.positions.push_back({i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f});
    m.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return m;
}

inline ShapeDescription patch_of(Vec3 p00, Vec3 p10, Vec3 p01, Vec3 p11) {
    BilinearMesh m;
    m.positions = {p00, p10, p01, p11};
    m.patches = {{0, 1, 2, 3}};
    return shape_of(std::make_shared<const BilinearMesh>(std::move(m)));
}

inline Sphere whole_sphere(float radius) {
    return {radius, -radius, radius, 360};
}

inline AnimatedTransform placed(std::initializer_list<Transform> parts) {
    Transform t;
    for (const Transform& part : parts) t = t * part;
    return AnimatedTransform(t);
}

/// An image file that lives as long as this object.
class TemporaryImage {
  public:
    TemporaryImage(const std::vector<Rgb>& texels, int width, int height, Metadata metadata = {}) {
        static int count = 0;
        path_ = std::filesystem::temp_directory_path() /
                ("covtrace_lights_" + std::to_string(getpid()) + "_" + std::to_string(count++) +
                 ".exr");
        Image image;
        image.data = image.display = {0, 0, width, height};
        image.metadata = std::move(metadata);
        for (const char* name : {"R", "G", "B"}) image.add_channel(name);
        for (size_t i = 0; i < texels.size(); ++i)
            for (size_t c = 0; c < 3; ++c)
                image.channels[c].values[i] = texels[i][static_cast<int>(c)];
        write_exr(image, path_);
    }
    ~TemporaryImage() { std::filesystem::remove(path_); }
    TemporaryImage(const TemporaryImage&) = delete;
    TemporaryImage& operator=(const TemporaryImage&) = delete;
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

/// A dim gradient with one texel that is very much brighter.
inline std::vector<Rgb> sky_with_sun(int width, int height, int sun_x, int sun_y, float sun) {
    std::vector<Rgb> texels;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float f = 0.2f + 0.8f * float(y) / float(height) + 0.3f * float(x) / float(width);
            texels.push_back(x == sun_x && y == sun_y ? Rgb(sun, sun, 0.8f * sun)
                                                      : Rgb(0.5f * f, 0.7f * f, f));
        }
    return texels;
}

}  // namespace covtrace::test
