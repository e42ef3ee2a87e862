#include "core/noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace covtrace {

namespace {

/// The permutation of Perlin's reference implementation (https://mrl.cs.nyu.edu/~perlin/noise).
constexpr std::array<uint8_t, 256> kPermutation{
    151, 160, 137, 91,  90,  15,  131, 13,  201, 95,  96,  53,  194, 233, 7,   225, 140, 36,  103,
    30,  69,  142, 8,   99,  37,  240, 21,  10,  23,  190, 6,   148, 247, 120, 234, 75,  0,   26,
    197, 62,  94,  252, 219, 203, 117, 35,  11,  32,  57,  177, 33,  88,  237, 149, 56,  87,  174,
    20,  125, 136, 171, 168, 68,  175, 74,  165, 71,  134, 139, 48,  27,  166, 77,  146, 158, 231,
    83,  111, 229, 122, 60,  211, 133, 230, 220, 105, 92,  41,  55,  46,  245, 40,  244, 102, 143,
    54,  65,  25,  63,  161, 1,   216, 80,  73,  209, 76,  132, 187, 208, 89,  18,  169, 200, 196,
    135, 130, 116, 188, 159, 86,  164, 100, 109, 198, 173, 186, 3,   64,  52,  217, 226, 250, 124,
    123, 5,   202, 38,  147, 118, 126, 255, 82,  85,  212, 207, 206, 59,  227, 47,  16,  58,  17,
    182, 189, 28,  42,  223, 183, 170, 213, 119, 248, 152, 2,   44,  154, 163, 70,  221, 153, 101,
    155, 167, 43,  172, 9,   129, 22,  39,  253, 19,  98,  108, 110, 79,  113, 224, 232, 178, 185,
    112, 104, 218, 246, 97,  228, 251, 34,  242, 193, 238, 210, 144, 12,  191, 179, 162, 241, 81,
    51,  145, 235, 249, 14,  239, 107, 49,  192, 214, 31,  181, 199, 106, 157, 184, 84,  204, 176,
    115, 121, 50,  45,  127, 4,   150, 254, 138, 236, 205, 93,  222, 114, 67,  29,  24,  72,  243,
    141, 128, 195, 78,  66,  215, 61,  156, 180};

uint8_t permuted(int i) {
    return kPermutation[static_cast<size_t>(i & 255)];
}

/// The product of the offset `d` from a corner and the corner's gradient, one of twelve, four of
/// them twice. Which corner has which is as in pbrt-v4, whose choice is not Perlin's.
float gradient(int x, int y, int z, Vec3 d) {
    const int h = permuted(permuted(permuted(x) + y) + z) & 15;
    const bool is_extra = h == 12 || h == 13;
    const float u = h < 8 || is_extra ? d.x : d.y, v = h < 4 || is_extra ? d.y : d.z;
    return ((h & 1) != 0 ? -u : u) + ((h & 2) != 0 ? -v : v);
}

float between(float a, float b, float t) {
    return (1 - t) * a + t * b;
}

float smooth(float t) {
    return t * t * t * (t * (t * 6 - 15) + 10);
}

float smooth_step(float from, float to, float x) {
    const float t = clamp01((x - from) / (to - from));
    return t * t * (3 - 2 * t);
}

/// Number of octaves that a footprint leaves: a fraction stands for the last one, kept in part.
float octaves_left(float footprint, int most) {
    if (!(footprint > 0)) return static_cast<float>(most);
    return std::min(std::max(0.0f, -1 - std::log2(footprint)), static_cast<float>(most));
}

/// Calls `add(weight, frequency, share)` for every octave; `share`: how much of the octave counts.
template <typename Add>
void for_octaves(float footprint, const Octaves& octaves, const Add& add) {
    constexpr float kLacunarity = 1.99f;
    const float left = octaves_left(footprint, octaves.most);
    const int whole = static_cast<int>(left);
    float weight = 1, frequency = 1;
    for (int i = 0; i < whole; ++i) {
        add(weight, frequency, 1.0f);
        frequency *= kLacunarity;
        weight *= octaves.omega;
    }
    add(weight, frequency, smooth_step(0.3f, 0.7f, left - static_cast<float>(whole)));
}

}  // namespace

float noise(Vec3 p) {
    std::array<int, 3> cell{};
    Vec3 d;
    for (int axis = 0; axis < 3; ++axis) {
        // Perlin's cells repeat after 256.
        const float x = std::fmod(p[axis], 256.0f);
        if (!std::isfinite(x)) return 0;
        const float floor = std::floor(x);
        cell[static_cast<size_t>(axis)] = static_cast<int>(floor) & 255;
        d[axis] = x - floor;
    }
    const auto corner = [&](int x, int y, int z) {
        return gradient(cell[0] + x, cell[1] + y, cell[2] + z,
                        d - Vec3{float(x), float(y), float(z)});
    };
    const float wx = smooth(d.x), wy = smooth(d.y), wz = smooth(d.z);
    const auto along_x = [&](int y, int z) {
        return between(corner(0, y, z), corner(1, y, z), wx);
    };
    const auto over_y = [&](int z) { return between(along_x(0, z), along_x(1, z), wy); };
    return between(over_y(0), over_y(1), wz);
}

float fractal_noise(Vec3 p, float footprint, const Octaves& octaves) {
    float sum = 0;
    for_octaves(footprint, octaves, [&](float weight, float frequency, float share) {
        if (share > 0) sum += weight * share * noise(frequency * p);
    });
    return sum;
}

float turbulence(Vec3 p, float footprint, const Octaves& octaves) {
    constexpr float kMean = 0.2f;  // of the absolute value, as pbrt-v4 has it
    float sum = 0;
    for_octaves(footprint, octaves, [&](float weight, float frequency, float share) {
        const float value = share > 0 ? std::abs(noise(frequency * p)) : 0.0f;
        sum += weight * between(kMean, value, share);
    });
    // The octave that is there in part counts as left out, too, as in pbrt-v4.
    float weight = 1;
    const int whole = static_cast<int>(octaves_left(footprint, octaves.most));
    for (int i = 0; i < octaves.most; ++i, weight *= octaves.omega)
        if (i >= whole) sum += weight * kMean;
    return sum;
}

NoiseEnergy noise_energy(float footprint, const Octaves& octaves) {
    // Noise over three million places: its variance, and the mean square of its slopes along the
    // axes (which differ by a tenth, as do the gradients' shares) over that variance and (2 pi)^2.
    constexpr float kVariance = 0.0716f, kSquareFrequency = 0.1747f;
    NoiseEnergy energy;
    for_octaves(footprint, octaves, [&](float weight, float frequency, float share) {
        const float variance = kVariance * sqr(weight * share);
        energy.all += variance;
        energy.slope += variance * kSquareFrequency * sqr(frequency);
    });
    return energy;
}

std::optional<Vec2> dot_center(Vec2 st) {
    const float s = std::floor(st.x + 0.5f), t = std::floor(st.y + 0.5f);
    // The offsets are pbrt-v4's: places of the noise that have nothing to do with each other.
    const auto value = [&](float ds, float dt) { return noise({s + ds, t + dt, 0.5f}); };
    if (!(value(0.5f, 0.5f) > 0)) return std::nullopt;
    constexpr float kMostShift = 0.5f - kDotRadius;
    return Vec2{s + kMostShift * value(1.5f, 2.8f), t + kMostShift * value(4.5f, 9.8f)};
}

}  // namespace covtrace
