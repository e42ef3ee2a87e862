/// Mean and variance of the light that paths of a scene bring.
#pragma once

#include <cmath>

#include "core/parallel.h"
#include "core/rng.h"
#include "integrator/path.h"
#include "integrator/render_scene.h"

namespace covtrace::test {

/// Mean and variance of the luminance of paths.
struct Moments {
    double count = 0, sum = 0, squares = 0;
    double mean() const { return sum / count; }
    double variance() const { return squares / count - mean() * mean(); }
    double error() const { return std::sqrt(variance() / count); }  ///< of the mean, standard
    void add(double y) { count += 1, sum += y, squares += y * y; }
};

/// Traces paths from one place of the film, in pixels, with a pinhole at the shutter's opening.
inline Moments trace_place(const RenderScene& scene, Vec2 place, int paths) {
    Moments m;
    for (int i = 0; i < paths; ++i) {
        const Sampler sampler(3, i & 0xffff, i >> 16, 0);
        const Ray ray = scene.camera.generate_ray(place, {}, 0);
        m.add(luminance(
            trace_path(scene, ray, sampler, scene.description.max_depth, nullptr).radiance));
    }
    return m;
}

/// Traces 262144 paths from all over the film; `key` tells their random numbers from others.
inline Moments trace_many(const RenderScene& scene, uint64_t key) {
    constexpr int64_t kChunks = 64, kPaths = 4096;
    const float size = float(scene.description.film.width);
    std::vector<Moments> parts(kChunks);
    parallel_for(kChunks, [&](int64_t chunk) {
        Moments& m = parts[size_t(chunk)];
        for (int64_t i = 0; i < kPaths; ++i) {
            Rng rng((key << 40) + uint64_t(chunk * kPaths + i));
            const Vec2 place = rng.next_2d();
            const Ray ray =
                scene.camera.generate_ray(place * size, rng.next_2d(), rng.next_float());
            const Sampler sampler(key, int(chunk), int(i), 0);
            const double y = luminance(
                trace_path(scene, ray, sampler, scene.description.max_depth, nullptr).radiance);
            m.add(y);
        }
    });
    Moments all;
    for (const Moments& m : parts) all.count += m.count, all.sum += m.sum, all.squares += m.squares;
    return all;
}

}  // namespace covtrace::test
