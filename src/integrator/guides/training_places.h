/// Places where paths from the camera scatter: where guides are learnt before the first sample.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "bsdf/bsdf.h"
#include "core/hash.h"
#include "core/parallel.h"
#include "core/rng.h"
#include "integrator/guides/caustic_guide.h"
#include "integrator/lit_scene.h"
#include "integrator/path.h"

namespace covtrace {

/// The beginning of a camera path that guides learn from.
struct TrainingPath {
    Rng rng;          ///< for what is drawn beside the path
    Vec2 place;       ///< in the image, both coordinates in [0, 1)
    Ray ray;          ///< from the camera
    Sampler sampler;  ///< of the path
};

/// Path number `index` of those that learn under a key, at a random place of the image.
inline TrainingPath training_path(const LitScene& scene, uint64_t key, uint64_t index) {
    const FilmDescription& film = scene.description.film;
    Rng rng(hash_combine(key, index));
    const Vec2 place = rng.next_2d(), lens = rng.next_2d();
    const Ray ray = scene.camera.generate_ray(
        {place.x * float(film.width), place.y * float(film.height)}, lens, rng.next_float());
    return {rng, place, ray, Sampler(key, int(index & 0xffff), int(index >> 16), 0)};
}

/// Traces `count` camera paths that no guide leads, the first of them number `first`, and calls
/// `visit(vertex, path.rng, found)` for every vertex that scatters by other than specular lobes.
/// `key` tells the random numbers of one kind of guide from another's. Returns all that the visits
/// put into `found`, in the order of the paths: it is the same for any number of threads. Throws
/// Error(interrupted) where the scene is interrupted.
template <typename Found, typename Visit>
std::vector<Found> visit_places(const LitScene& scene, uint64_t key, int64_t first, int64_t count,
                                const Visit& visit) {
    constexpr int64_t kPathsPerChunk = 64;  // paths that one task traces
    constexpr int kDepth = 4;               // most scattering events of a path
    const int depth = std::min(kDepth, scene.description.max_depth);
    const CausticGuide none;
    const int64_t chunks = (count + kPathsPerChunk - 1) / kPathsPerChunk;
    std::vector<std::vector<Found>> found(static_cast<size_t>(chunks));
    parallel_for(chunks, [&](int64_t chunk) {
        PathRecord record;
        const int64_t end = std::min(count, (chunk + 1) * kPathsPerChunk);
        for (int64_t i = chunk * kPathsPerChunk; i < end; ++i) {
            scene.throw_if_interrupted();
            TrainingPath path = training_path(scene, key, static_cast<uint64_t>(first + i));
            trace_path(scene, none, path.ray, path.sampler, depth, &record);
            for (int k = 0; k < record.count; ++k) {
                const PathVertex& vertex = record.vertices[static_cast<size_t>(k)];
                const LobeShares& lobes = vertex.next_event.lobes;
                if (!vertex.scatters || lobes.count == 0 || is_specular(lobes.lobes[0].kind))
                    continue;
                visit(vertex, path.rng, found[static_cast<size_t>(chunk)]);
            }
        }
    });
    std::vector<Found> all;
    for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
    return all;
}

}  // namespace covtrace
