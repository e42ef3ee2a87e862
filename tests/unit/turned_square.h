// A shiny square whose vertices have normals of another surface, above a black floor.
#pragma once

#include <string>

#include "integrator/path.h"
#include "pbrt/read_scene.h"

namespace covtrace::test {

/// The square z = 0, |x| < 1, |y| < 1, in a white surrounding over a black floor. Its normals lean
/// towards +x, more so where x is larger, and to both sides of y = 0.
inline RenderScene turned_square(const std::string& material) {
    return RenderScene(read_pbrt_string(R"(WorldBegin
LightSource "infinite" "rgb L" [ 1 1 1 ]
Material )" + material + R"(
Shape "trianglemesh" "point3 P" [ -1 -1 0  1 -1 0  1 1 0  -1 1 0 ]
    "normal N" [ 0.3 -0.2 1  0.5 -0.2 1  0.5 0.2 1  0.3 0.2 1 ] "integer indices" [ 0 1 2  0 2 3 ]
Material "diffuse" "rgb reflectance" [ 0 0 0 ]
Translate 0 0 -0.5
Shape "disk" "float radius" 1000)",
                                        "test", "."));
}

/// The ray that sees a place on the square from -x, by `angle` from the vertical.
inline Ray towards(Vec3 place, float angle) {
    const Vec3 w{-std::sin(angle), 0, std::cos(angle)};
    return {place + w, -w};
}

constexpr const char* kMetal = R"("conductor" "rgb reflectance" [ 0.8 0.8 0.8 ])";

}  // namespace covtrace::test
