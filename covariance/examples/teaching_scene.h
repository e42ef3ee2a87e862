// A scene of the kind that any small path tracer has, for path_tracer.cpp: spheres and
// parallelograms, three materials, two textures, one lamp under an even sky, a camera with lens and
// shutter, and a writer of PNG files. Nothing in here is about covariances but the namespace of the
// vector.
#pragma once

#include <array>
#include <cmath>
#include <covariance/vec3.hpp>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

using Vec = covariance::Vec3<double>;  // + - * /, dot, cross, length, normalize; yours will do, too

inline Vec times(const Vec& a, const Vec& b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}
inline double mean(const Vec& color) {
    return (color.x + color.y + color.z) / 3;
}

/// Random numbers that follow from pixel, sample and pass alone, so that every run gives the same
/// bits.
struct Random {
    std::uint64_t state;
    Random(std::uint64_t pixel, std::uint64_t sample, std::uint64_t pass)
        : state((pixel * 0x9e3779b97f4a7c15U + sample) * 0xd1342543de82ef95U + pass) {}
    double next() {  // splitmix64
        std::uint64_t z = (state += 0x9e3779b97f4a7c15U);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
        return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
    }
};

enum class Kind { diffuse, mirror, fuzzy, lamp };
enum class Pattern { none, checks, solid_checks };

struct Material {
    Kind kind = Kind::diffuse;
    Vec color{0.7, 0.7, 0.7};
    Pattern pattern = Pattern::none;
    double cell = 0.5;  ///< side of a check
    double fuzz = 0;    ///< radius of the ball that is added to the mirror direction
};

struct Sphere {
    Vec center;
    double radius;
    Material material;
    Vec velocity{};  ///< metres per second
};

struct Quad {
    Vec corner, side_1, side_2;  ///< at right angles
    Material material;
};

struct Hit {
    double distance = 1e30;
    Vec position, normal, tangent_1, tangent_2;
    double curvature = 0;  ///< 1/radius of a sphere, seen from outside
    Vec velocity;
    Vec in_object;  ///< the position in the object's own axes, for textures
    const Material* material = nullptr;
};

struct Scene {
    std::vector<Sphere> spheres;
    std::vector<Quad> quads;  ///< the first is the lamp
    Vec radiance{14, 13, 11}, sky{0.25, 0.3, 0.4};

    Hit intersect(const Vec& o, const Vec& d, double time) const {
        Hit hit;
        for (const Sphere& s : spheres) {
            const Vec c = s.center + time * s.velocity, oc = c - o;
            const double b = dot(oc, d), disc = b * b - dot(oc, oc) + s.radius * s.radius;
            if (disc < 0) continue;
            const double root = std::sqrt(disc), t = b - root > 1e-6 ? b - root : b + root;
            if (t < 1e-6 || t > hit.distance) continue;
            const Vec n = (o + t * d - c) / s.radius;
            const Vec t1 = normalize(cross(std::abs(n.y) < 0.9 ? Vec{0, 1, 0} : Vec{1, 0, 0}, n));
            hit = {t,          c + s.radius * n, n,          t1, cross(n, t1), 1 / s.radius,
                   s.velocity, s.radius * n,     &s.material};
        }
        for (const Quad& q : quads) {
            const Vec n = normalize(cross(q.side_1, q.side_2));
            const double t = dot(q.corner - o, n) / dot(d, n);
            if (!(t > 1e-6 && t < hit.distance)) continue;
            const Vec p = o + t * d, local = p - q.corner;
            const double l1 = length(q.side_1), l2 = length(q.side_2);
            const Vec t1 = q.side_1 / l1, t2 = q.side_2 / l2;
            const double s1 = dot(local, t1), s2 = dot(local, t2);
            if (s1 < 0 || s2 < 0 || s1 > l1 || s2 > l2) continue;
            hit = {t, p, n, t1, t2, 0, {}, {s1, s2, 0}, &q.material};
        }
        return hit;
    }

    bool is_free(const Vec& from, const Vec& to, double time) const {
        const double way = length(to - from);
        return intersect(from, (to - from) / way, time).distance > way - 1e-5;
    }
};

/// Distances from a point to the nearest faces of the checks, per axis.
inline Vec edges_of_checks(const Vec& p, double cell) {
    const auto edge = [cell](double x) { return std::abs(x - cell * std::round(x / cell)); };
    return {edge(p.x), edge(p.y), edge(p.z)};
}

inline Vec color_at(const Hit& hit) {
    const Material& m = *hit.material;
    if (m.pattern == Pattern::none) return m.color;
    const auto half = [&m](double x) { return static_cast<long>(std::floor(x / m.cell)); };
    const Vec& p = hit.in_object;
    const bool dark = (half(p.x) + half(p.y) + half(p.z)) % 2 != 0;
    return dark ? 0.25 * m.color : m.color;
}

inline Scene make_scene() {
    Scene s;
    s.quads = {
        {{-0.7, 3.2, -1.2}, {1.4, 0, 0}, {0, 0, 1.4}, {.kind = Kind::lamp}},
        {{-5, 0, -3}, {0, 0, 8}, {10, 0, 0}, {.color = {.8, .75, .7}, .pattern = Pattern::checks}},
        {{-5, 0, -3}, {10, 0, 0}, {0, 4, 0}, {.color = {.7, .7, .75}}},
        {{-2.6, 0, -3}, {0, 3, 0}, {0, 0, 4}, {.color = {.75, .3, .25}}},
        {{0.35, 0, 1.1}, {0.5, 0, 0}, {0, 0.7, 0}, {.color = {.3, .6, .35}}}};
    s.spheres = {
        {{-1.2, 0.8, -1.2}, 0.8, {.kind = Kind::mirror, .color = {.9, .9, .9}}},
        {{1.7, 0.6, -1.3}, 0.6, {.kind = Kind::fuzzy, .color = {.9, .75, .5}, .fuzz = 0.25}},
        {{0.3, 0.5, -0.2},
         0.5,
         {.color = {.75, .75, .85}, .pattern = Pattern::solid_checks, .cell = 0.3},
         {6, 0, 0}}};
    return s;
}

/// Writes an 8-bit sRGB picture, without compression.
inline bool write_png(const std::string& name, int width, int height,
                      const std::vector<Vec>& image) {
    std::vector<std::uint8_t> raw;
    for (int y = 0; y < height; ++y) {
        raw.push_back(0);  // no prediction
        for (int x = 0; x < width; ++x) {
            const Vec& c = image[static_cast<std::size_t>(y * width + x)];
            for (const double v : {c.x, c.y, c.z}) {
                const double u = v < 0 ? 0 : v > 1 ? 1 : v;
                const double srgb =
                    u <= 0.0031308 ? 12.92 * u : 1.055 * std::pow(u, 1 / 2.4) - 0.055;
                raw.push_back(static_cast<std::uint8_t>(std::lround(255 * srgb)));
            }
        }
    }
    std::vector<std::uint8_t> file{0x89, 'P', 'N', 'G', 13, 10, 26, 10};
    const auto put = [](std::vector<std::uint8_t>& to, std::uint32_t v) {
        for (int shift = 24; shift >= 0; shift -= 8)
            to.push_back(static_cast<std::uint8_t>(v >> shift));
    };
    const auto chunk = [&](const char* type, const std::vector<std::uint8_t>& data) {
        put(file, static_cast<std::uint32_t>(data.size()));
        const std::size_t begin = file.size();
        file.insert(file.end(), type, type + 4);
        file.insert(file.end(), data.begin(), data.end());
        std::uint32_t crc = ~0U;
        for (std::size_t i = begin; i < file.size(); ++i) {
            crc ^= file[i];
            for (int k = 0; k < 8; ++k) crc = crc & 1 ? crc >> 1 ^ 0xedb88320U : crc >> 1;
        }
        put(file, ~crc);
    };
    std::vector<std::uint8_t> header;
    put(header, static_cast<std::uint32_t>(width));
    put(header, static_cast<std::uint32_t>(height));
    header.insert(header.end(), {8, 2, 0, 0, 0});
    std::vector<std::uint8_t> packed{0x78, 1};  // zlib: blocks that are only stored
    std::uint32_t a = 1, b = 0;
    for (std::size_t i = 0; i < raw.size(); i += 65535) {
        const std::size_t n = std::min<std::size_t>(65535, raw.size() - i);
        const auto low = [](std::size_t v) { return static_cast<std::uint8_t>(v & 255); };
        packed.insert(packed.end(),
                      {low(i + n == raw.size()), low(n), low(n >> 8), low(~n), low(~n >> 8)});
        for (std::size_t k = i; k < i + n; ++k) {
            packed.push_back(raw[k]);
            a = (a + raw[k]) % 65521;
            b = (b + a) % 65521;
        }
    }
    put(packed, b << 16 | a);
    chunk("IHDR", header);
    chunk("IDAT", packed);
    chunk("IEND", {});
    std::FILE* out = std::fopen(name.c_str(), "wb");
    if (!out) return false;
    const bool is_written = std::fwrite(file.data(), 1, file.size(), out) == file.size();
    return std::fclose(out) == 0 && is_written;
}
