#include "render/pass.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/parallel.h"
#include "frequency/replay.h"

namespace covtrace {

namespace {

constexpr int kTileSize = 16;
constexpr size_t kMostRejectedKept = 8;

/// Runs body(film pixel index, x, y, statistics) for all pixels, tile by tile, and sums the
/// statistics in tile order.
template <typename Body>
PassStatistics for_each_pixel(const PixelBounds& b, const Monitor& monitor,
                              const PassProgress& progress, const Body& body) {
    const int tiles_x = (b.width() + kTileSize - 1) / kTileSize;
    const int tiles_y = (b.height() + kTileSize - 1) / kTileSize;
    const int64_t tiles = int64_t(tiles_x) * tiles_y;
    std::vector<PassStatistics> per_tile(static_cast<size_t>(tiles));
    std::atomic<int64_t> done{0};
    parallel_for(tiles, [&](int64_t tile) {
        if (monitor.cancelled()) return;
        const int x0 = b.x0 + int(tile % tiles_x) * kTileSize,
                  y0 = b.y0 + int(tile / tiles_x) * kTileSize;
        PassStatistics& statistics = per_tile[static_cast<size_t>(tile)];
        for (int y = y0; y < std::min(y0 + kTileSize, b.y1); ++y)
            for (int x = x0; x < std::min(x0 + kTileSize, b.x1); ++x) {
                const size_t i = size_t(y - b.y0) * size_t(b.width()) + size_t(x - b.x0);
                body(i, x, y, statistics);
            }
        progress(double(++done) / double(tiles));
    });
    PassStatistics sum;
    for (const PassStatistics& s : per_tile) sum.add(s);
    return sum;
}

/// Takes the pixel's next sample into the film.
void sample_pixel(const PassContext& context, Film& film, size_t pixel, int x, int y,
                  PathRecord* record, PassStatistics& statistics) {
    PathResult path;
    const uint32_t index = film.pixels[pixel].count;
    FilmPixel::Sample s = take_sample(context, x, y, index, record, path);
    ++statistics.samples;
    statistics.rays += path.rays;
    statistics.vertices += path.vertices;
    if (is_black(path.radiance)) ++statistics.black_paths;
    if (!is_finite(s.radiance)) {
        ++statistics.rejected;
        if (statistics.first_rejected.size() < kMostRejectedKept)
            statistics.first_rejected.push_back({x, y, index});
        s.radiance = Rgb(0);
    }
    film.add(pixel, s);
}

}  // namespace

void PassStatistics::add(const PassStatistics& other) {
    samples += other.samples;
    rays += other.rays;
    vertices += other.vertices;
    black_paths += other.black_paths;
    rejected += other.rejected;
    for (const RejectedSample& r : other.first_rejected)
        if (first_rejected.size() < kMostRejectedKept) first_rejected.push_back(r);
}

FilmPixel::Sample take_sample(const PassContext& context, int x, int y, uint32_t index,
                              PathRecord* record, PathResult& path) {
    Sampler sampler(context.seed, x, y, index);
    const Sampler::CameraSample u = sampler.camera();
    const PixelFilter::Sample position = context.scene.filter.sample(u.film);
    const Vec2 film{float(x) + 0.5f + position.offset.x, float(y) + 0.5f + position.offset.y};
    const Ray ray = context.scene.camera.generate_ray(film, u.lens, u.time);
    path = trace_path(context.scene, ray, sampler, context.max_depth, record);
    FilmPixel::Sample s;
    s.rays = path.rays;
    s.radiance = path.radiance * context.imaging_scale;
    const float largest = max_component(s.radiance);
    if (largest > context.max_component) s.radiance *= context.max_component / largest;
    s.radiance *= position.weight;
    s.albedo = path.albedo;
    s.normal = path.normal;
    s.depth = path.depth;
    s.hit = path.hit;
    return s;
}

PassStatistics radiance_pass(const PassContext& context, Film& film,
                             std::span<const uint32_t> counts, const Monitor& monitor,
                             const PassProgress& progress) {
    return for_each_pixel(film.bounds, monitor, progress,
                          [&](size_t i, int x, int y, PassStatistics& statistics) {
                              for (uint32_t s = 0; s < counts[i]; ++s)
                                  sample_pixel(context, film, i, x, y, nullptr, statistics);
                          });
}

PassStatistics covariance_pass(const PassContext& context, const VoxelGrid* occluders, Film& film,
                               std::span<const uint32_t> counts, CovarianceBuffer& buffer,
                               const Monitor& monitor, const PassProgress& progress) {
    const PathReplay replay(context.scene, occluders);
    const auto traced = [&](size_t i, int x, int y, PassStatistics& statistics) {
        static thread_local PathRecord record;
        sample_pixel(context, film, i, x, y, &record, statistics);
        return replay(record);
    };
    const auto share_of_first = [&counts] {
        uint64_t first = 0, all = 0;
        for (uint32_t c : counts) {
            first += c > 0;
            all += c;
        }
        return all > 0 ? double(first) / double(all) : 1.0;
    }();

    // The first path of every pixel alone: its weights give the limit for all.
    PassStatistics statistics = for_each_pixel(
        film.bounds, monitor, [&](double f) { progress(f * share_of_first); },
        [&](size_t i, int x, int y, PassStatistics& s) {
            if (counts[i] == 0) return;
            const PathCovariance p = traced(i, x, y, s);
            buffer.covariance[i] = covariance::cast<float>(p.sigma);
            buffer.weight[i] = float(p.weight);
        });
    double sum = 0, lit = 0;
    for (size_t i = 0; i < counts.size(); ++i) {
        sum += buffer.weight[i];
        lit += counts[i] > 0;
    }
    const float most = lit > 0 ? float(10 * sum / lit) : 0.0f;

    statistics.add(for_each_pixel(
        film.bounds, monitor,
        [&](double f) { progress(share_of_first + f * (1 - share_of_first)); },
        [&](size_t i, int x, int y, PassStatistics& s) {
            covariance::Accumulator<double> mean;
            mean.add(covariance::cast<double>(buffer.covariance[i]),
                     std::min(buffer.weight[i], most));
            for (uint32_t k = 1; k < counts[i]; ++k) {
                const PathCovariance p = traced(i, x, y, s);
                mean.add(p.sigma, std::min(p.weight, double(most)));
            }
            buffer.covariance[i] = covariance::cast<float>(mean.mean());
            buffer.weight[i] = counts[i] > 0 ? float(mean.weight() / counts[i]) : 0.0f;
        }));
    return statistics;
}

}  // namespace covtrace
