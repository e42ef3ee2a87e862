/// Mean and variance of the light that paths of a scene bring.
#pragma once

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
};

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
            m.count += 1, m.sum += y, m.squares += y * y;
        }
    });
    Moments all;
    for (const Moments& m : parts) all.count += m.count, all.sum += m.sum, all.squares += m.squares;
    return all;
}

}  // namespace covtrace::test
