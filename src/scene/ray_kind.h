/// Kinds of rays, as only some of them may see a shape or a sky.
#pragma once

#include <cstdint>

namespace covtrace {

/// Where a ray comes from: the camera, or the lobe of the surface, or the medium, that scattered
/// the path last. `glossy` is any reflection but a diffuse one, `transmission` every ray to the
/// other side of a surface, `shadow` a ray to a sampled light. A ray of the kind `any`, which no
/// path has, meets all surfaces.
enum class RayKind : uint8_t { any, camera, diffuse, glossy, transmission, volume, shadow };

/// A set of kinds: bit k for the kind number k.
using RayKinds = uint8_t;

constexpr RayKinds set_of(RayKind kind) {
    return static_cast<RayKinds>(1u << static_cast<unsigned>(kind));
}
constexpr bool contains(RayKinds set, RayKind kind) {
    return (set & set_of(kind)) != 0;
}

inline constexpr RayKinds kEveryRay = 0x7f;
/// The kinds of rays that something has scattered.
inline constexpr RayKinds kScatteredRays = set_of(RayKind::diffuse) | set_of(RayKind::glossy) |
                                           set_of(RayKind::transmission) | set_of(RayKind::volume);

}  // namespace covtrace
