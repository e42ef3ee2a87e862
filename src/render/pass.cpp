#include "render/pass.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>

#include "core/parallel.h"
#include "frequency/replay.h"

namespace covtrace {

namespace {

constexpr int kTileSize = 16;
constexpr size_t kMostRejectedKept = 8;

/// Adds the seconds that a scope took.
class Stopwatch {
  public:
    explicit Stopwatch(double& total) : total_(total), start_(Clock::now()) {}
    ~Stopwatch() { total_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
    Stopwatch(const Stopwatch&) = delete;
    Stopwatch& operator=(const Stopwatch&) = delete;

  private:
    using Clock = std::chrono::steady_clock;
    double& total_;
    const Clock::time_point start_;
};

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
        const Stopwatch watch(statistics.seconds);
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
    statistics.rays.add(path.rays);
    statistics.vertices += path.vertices;
    ++statistics.lengths[std::min<size_t>(path.vertices, PassStatistics::kLengths - 1)];
    if (is_black(path.radiance)) ++statistics.black_paths;
    if (!is_finite(s.radiance)) {
        ++statistics.rejected;
        if (statistics.first_rejected.size() < kMostRejectedKept)
            statistics.first_rejected.push_back({x, y, index});
        s.radiance = s.in_view = Rgb(0);
    }
    film.add(pixel, s);
}

}  // namespace

void PassStatistics::add(const PassStatistics& other) {
    samples += other.samples;
    rays.add(other.rays);
    for (size_t i = 0; i < lengths.size(); ++i) lengths[i] += other.lengths[i];
    vertices += other.vertices;
    black_paths += other.black_paths;
    rejected += other.rejected;
    seconds += other.seconds;
    replay_seconds += other.replay_seconds;
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
    s.rays = uint32_t(path.rays.total());
    const auto balanced = [&context](Rgb c) {
        const Rgb light = c * context.imaging_scale;
        const auto channel = [&](size_t i) {
            const auto& row = context.white_balance[i];
            return row[0] * light.r + row[1] * light.g + row[2] * light.b;
        };
        return Rgb{channel(0), channel(1), channel(2)};
    };
    s.radiance = balanced(path.radiance);
    s.in_view = balanced(path.in_view);
    const float largest = max_component(s.radiance);
    const float limit = largest > context.max_component ? context.max_component / largest : 1.0f;
    s.radiance *= limit * position.weight;
    s.in_view *= limit * position.weight;
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

namespace {

bool shows_emitter(const PathRecord& record) {
    if (record.escaped > 0 && record.escape_in_view) return true;
    for (int i = 0; i < record.count; ++i) {
        const PathVertex& v = record.vertices[size_t(i)];
        if (!v.in_view) return false;  // nor is any after it
        if (v.emitted > 0) return true;
    }
    return false;
}

}  // namespace

PassStatistics covariance_pass(const PassContext& context, const Occluders& occluders,
                               BrdfCovariance rule, Film& film, std::span<const uint32_t> counts,
                               CovarianceBuffers& buffers, const Monitor& monitor,
                               const PassProgress& progress) {
    const PathReplay replay(context.scene, occluders, rule);
    struct Traced {
        PathCovariance scattered, in_view;
    };
    const auto traced = [&](size_t i, int x, int y, PassStatistics& statistics) {
        static thread_local PathRecord record;
        sample_pixel(context, film, i, x, y, &record, statistics);
        const Stopwatch watch(statistics.replay_seconds);
        Traced t{replay(record, LightPart::scattered), {}};
        if (shows_emitter(record)) t.in_view = replay(record, LightPart::in_view);
        return t;
    };
    const auto share_of_first = [&counts] {
        uint64_t first = 0, all = 0;
        for (uint32_t c : counts) {
            first += c > 0;
            all += c;
        }
        return all > 0 ? double(first) / double(all) : 1.0;
    }();
    const auto store = [](CovarianceBuffer& buffer, size_t i, const PathCovariance& p) {
        buffer.covariance[i] = covariance::cast<float>(p.sigma);
        buffer.weight[i] = float(p.weight);
    };

    // The first path of every pixel alone: its weights give the limit for all.
    PassStatistics statistics = for_each_pixel(
        film.bounds, monitor, [&](double f) { progress(f * share_of_first); },
        [&](size_t i, int x, int y, PassStatistics& s) {
            if (counts[i] == 0) return;
            const Traced t = traced(i, x, y, s);
            store(buffers.scattered, i, t.scattered);
            store(buffers.in_view, i, t.in_view);
        });
    double sum = 0, lit = 0;
    for (size_t i = 0; i < counts.size(); ++i) {
        sum += buffers.scattered.weight[i];
        lit += counts[i] > 0;
    }
    const double most = lit > 0 ? 10 * sum / lit : 0.0;

    statistics.add(for_each_pixel(
        film.bounds, monitor,
        [&](double f) { progress(share_of_first + f * (1 - share_of_first)); },
        [&](size_t i, int x, int y, PassStatistics& s) {
            if (counts[i] == 0) return;
            covariance::Accumulator<double> scattered, in_view;
            const auto add = [&](const PathCovariance& a, const PathCovariance& b) {
                scattered.add(a.sigma, std::min(a.weight, most));
                in_view.add(b.sigma, b.weight);
            };
            const auto stored = [i](const CovarianceBuffer& b) {
                return PathCovariance{covariance::cast<double>(b.covariance[i]), b.weight[i]};
            };
            add(stored(buffers.scattered), stored(buffers.in_view));
            for (uint32_t k = 1; k < counts[i]; ++k) {
                const Traced t = traced(i, x, y, s);
                add(t.scattered, t.in_view);
            }
            store(buffers.scattered, i, {scattered.mean(), scattered.weight() / counts[i]});
            store(buffers.in_view, i, {in_view.mean(), in_view.weight() / counts[i]});
        }));
    return statistics;
}

}  // namespace covtrace
