#include "integrator/guides/path_lesson.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "integrator/guides/block_brightness.h"
#include "integrator/guides/training_places.h"
#include "integrator/path.h"

namespace covtrace {

namespace {

constexpr uint64_t kLessonKey = 0x6c6573736f6eull;  // key of the random numbers, "lesson"
constexpr int64_t kPathsPerChunk = 64;              // paths that one task traces
constexpr double kMostRelative = 20;                // brightness over its block's that counts
/// Most scattering events of a path: light from further on tells little, and memory is bounded.
constexpr int kDepth = 16;

/// Paths of one task, each with the block of the image that it belongs to.
struct Chunk {
    PathLesson lesson;
    std::vector<uint16_t> blocks;  ///< of each path
    std::vector<float> brightness;
};

bool is_specular_event(const PathVertex& v) {
    return v.next_event.lobes.count > 0 && is_specular(v.next_event.lobes.lobes[0].kind);
}

/// Adds a path to a lesson. Non-finite paths tell nothing.
void add(PathLesson& lesson, const PathRecord& record, uint32_t path) {
    // Light found behind each vertex, by the light that reaches the sensor
    std::array<float, PathRecord::kCapacity + 1> behind;
    behind[size_t(record.count)] = record.escaped;
    for (int k = record.count - 1; k >= 0; --k) {
        const PathVertex& v = record.vertices[size_t(k)];
        behind[size_t(k)] = behind[size_t(k) + 1] + v.emitted + v.direct + v.mirrored;
    }
    if (!std::isfinite(behind[0])) return;
    int32_t open = -1;  // the bounce whose end is not known yet
    float left = 0;     // throughput behind it
    for (int k = 0; k < record.count; ++k) {
        const PathVertex& v = record.vertices[size_t(k)];
        if (!(v.carried > 0)) return;
        if (open >= 0) lesson.bounces[size_t(open)].found += v.emitted / left;
        if (v.medium >= 0 || v.is_specular) {
            // Light that a medium scatters is what the path tells of it
            if (v.medium >= 0 && open >= 0) {
                lesson.bounces[size_t(open)].found += (behind[size_t(k)] - v.emitted) / left;
                open = -1;
            }
            continue;
        }
        const auto visit = static_cast<int32_t>(lesson.places.size());
        if (open >= 0) {
            lesson.bounces[size_t(open)].to = visit;
            lesson.bounces[size_t(open)].passed = v.carried / left;
            open = -1;
        }
        // A body's light comes to where it leaves from outside, not from where the path was
        const bool may_learn = v.guided_normal != Vec3{};
        lesson.places.push_back(
            {v.hit.position, may_learn ? v.guided_normal : face_forward(v.shading.z, v.wo)});
        lesson.direct.push_back((v.direct + v.mirrored) / v.carried);
        lesson.light.push_back((behind[size_t(k)] - v.emitted) / v.carried);
        if (!(v.carried_on > 0) || !v.scatters || v.next_event.lobes.count == 0) continue;
        open = static_cast<int32_t>(lesson.bounces.size());
        left = v.carried_on;
        GuideBounce b;
        b.from = static_cast<uint32_t>(visit);
        b.is_guided = may_learn && !is_specular_event(v);
        b.direction = v.next_event.wi;
        b.value = v.next_value;
        b.path_pdf = v.next_value * v.carried / v.carried_on;
        b.bsdf_pdf = v.next_bsdf_pdf;
        b.carried = v.carried;
        b.reflected = v.carried_on / v.carried;
        b.path = path;
        lesson.bounces.push_back(b);
    }
    if (open >= 0) lesson.bounces[size_t(open)].found += record.escaped / left;
}

}  // namespace

void append(PathLesson& lesson, const PathLesson& more) {
    const auto visits = static_cast<uint32_t>(lesson.places.size());
    const auto join = [](auto& a, const auto& b) { a.insert(a.end(), b.begin(), b.end()); };
    join(lesson.places, more.places);
    join(lesson.direct, more.direct);
    join(lesson.light, more.light);
    for (GuideBounce b : more.bounces) {
        b.from += visits;
        if (b.to >= 0) b.to += static_cast<int32_t>(visits);
        lesson.bounces.push_back(b);
    }
    lesson.second_moment += more.second_moment;
    lesson.paths += more.paths;
}

PathLesson trace_lesson(const LitScene& scene, const CausticGuide& caustics, const SkyGuide& sky,
                        const LampGuide& lamps, const PathGuide& guide, int64_t first,
                        int64_t count) {
    std::vector<Chunk> chunks(static_cast<size_t>((count + kPathsPerChunk - 1) / kPathsPerChunk));
    parallel_for(int64_t(chunks.size()), [&](int64_t c) {
        Chunk& chunk = chunks[size_t(c)];
        PathRecord record;
        const int64_t end = std::min(count, (c + 1) * kPathsPerChunk);
        for (int64_t i = c * kPathsPerChunk; i < end; ++i) {
            scene.throw_if_interrupted();
            const auto index = static_cast<uint64_t>(first + i);
            const TrainingPath path = training_path(scene, kLessonKey, index);
            const PathResult result = trace_path(scene, caustics, path.ray, path.sampler,
                                                 std::min(scene.description.max_depth, kDepth),
                                                 &record, &sky, &lamps, &guide);
            const float light = luminance(result.radiance - result.in_view);
            chunk.blocks.push_back(BlockBrightness::block(path.place));
            chunk.brightness.push_back(std::isfinite(light) ? light : 0);
            add(chunk.lesson, record, static_cast<uint32_t>(index));
        }
    });
    BlockBrightness image;
    for (const Chunk& chunk : chunks)
        for (size_t i = 0; i < chunk.blocks.size(); ++i)
            image.add(chunk.blocks[i], chunk.brightness[i]);
    if (image.is_black()) return {};
    PathLesson lesson;
    for (size_t c = 0; c < chunks.size(); ++c) {
        Chunk& chunk = chunks[c];
        for (size_t i = 0; i < chunk.blocks.size(); ++i) {
            const double relative = std::min(
                double(chunk.brightness[i]) / image.around(chunk.blocks[i]), kMostRelative);
            chunk.lesson.second_moment += relative * relative;
        }
        for (GuideBounce& b : chunk.lesson.bounces) {
            const size_t i = size_t(int64_t(b.path) - first) - c * size_t(kPathsPerChunk);
            b.carried /= float(image.around(chunk.blocks[i]));
        }
        append(lesson, chunk.lesson);
    }
    lesson.paths = count;
    return lesson;
}

}  // namespace covtrace
