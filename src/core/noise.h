/// Solid noise, value for value that of pbrt-v4: what `fbm`, `wrinkled`, `windy`, `marble` and
/// `dots` are made of.
#pragma once

#include <optional>

#include "core/vec.h"

namespace covtrace {

/// Improved gradient noise (Perlin 2002, "Improving Noise") with cells of one unit: about -1 to 1,
/// 0 at whole coordinates, 0 in the mean. 0 where p is not finite.
float noise(Vec3 p);

/// Several octaves of noise, each 1.99 times as fast as the one before.
struct Octaves {
    int most = 8;
    float omega = 0.5f;  ///< how strong each is beside the one before
};

/// Sum of the octaves (fractional Brownian motion). Those that are finer than about two
/// `footprint`s, the larger one of a pixel's sides, are left out; 0 leaves none out.
float fractal_noise(Vec3 p, float footprint, const Octaves& octaves);
/// Sum of the octaves' absolute values; octaves that the footprint leaves out count with their
/// mean.
float turbulence(Vec3 p, float footprint, const Octaves& octaves);

/// Energy of the octaves that a footprint leaves. `all`: the variance of their sum; `slope`: the
/// sum over octaves of variance times mean square frequency along an axis, (cycles per unit)^2.
struct NoiseEnergy {
    float all = 0, slope = 0;
};
NoiseEnergy noise_energy(float footprint, const Octaves& octaves);

/// Radius of a dot, in units of its cell. Four in ten of the unit cells around points with whole
/// coordinates have a dot.
inline constexpr float kDotRadius = 0.35f;
/// The centre of the dot in the cell of (s, t), so placed that the whole dot lies within the cell;
/// empty where the cell has none.
std::optional<Vec2> dot_center(Vec2 st);

}  // namespace covtrace
