#include "render/pass.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>

#include "camera/film_rim.h"
#include "core/hash.h"
#include "core/parallel.h"
#include "covariance/occlusion.hpp"
#include "frequency/replay.h"
#include "integrator/path_batch.h"

namespace covtrace {

namespace {

/// Adds the seconds that a scope took to `total`.
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

/// Tells a pass when it has to stop before its end.
class Stop {
  public:
    explicit Stop(const Monitor& monitor) : monitor_(monitor) {}
    /// Whether to stop now. Only a pass that took a sample may pause: a render must get on, however
    /// short the time between its checkpoints.
    bool operator()() const {
        return monitor_.cancelled() ||
               (taken_.load(std::memory_order_relaxed) && paused_.load(std::memory_order_relaxed));
    }
    void took_samples() { taken_.store(true, std::memory_order_relaxed); }
    void look_at_clock() {
        if (monitor_.pause_is_due()) paused_.store(true, std::memory_order_relaxed);
    }

  private:
    const Monitor& monitor_;
    std::atomic<bool> taken_{false}, paused_{false};
};

/// Calls take(tile, stop, statistics) for the context's tiles, which takes their samples and
/// returns false where it was stopped; sums the statistics in tile order.
template <typename Take>
PassStatistics for_each_tile(const PassContext& context, const Film& film, const Monitor& monitor,
                             const PassProgress& progress, const Take& take) {
    const Tiles tiles(film.bounds);
    std::vector<PassStatistics> per_tile(static_cast<size_t>(tiles.count()));
    const double own_tiles = double(tiles.count(context.shard));
    std::atomic<int64_t> done{0};
    Stop stop(monitor);
    parallel_for(tiles.count(), [&](int64_t tile) {
        if (!tiles.belongs_to(tile, context.shard)) return;
        PassStatistics& statistics = per_tile[static_cast<size_t>(tile)];
        const Stopwatch watch(statistics.seconds);
        if (take(tiles.bounds(tile), stop, statistics)) progress(double(++done) / own_tiles);
    });
    PassStatistics sum;
    for (const PassStatistics& s : per_tile) sum.add(s);
    return sum;
}

/// Adds the pixel's next sample to the film.
void add_sample(const PassContext& context, Film& film, size_t pixel, int x, int y,
                const PathResult& path, FilmSample s, PassStatistics& statistics) {
    const uint32_t index = film.pixels[pixel].count;
    ++statistics.samples;
    statistics.rays.add(path.rays);
    statistics.vertices += path.vertices;
    ++statistics.lengths[std::min<size_t>(path.vertices, PassStatistics::kLengths - 1)];
    if (is_black(path.radiance)) ++statistics.black_paths;
    if (!is_finite(s.radiance)) {
        ++statistics.rejected;
        if (statistics.first_rejected.size() < PassStatistics::kMostRejectedKept)
            statistics.first_rejected.push_back({x, y, context.sample_name(index)});
        s.radiance = s.in_view = Rgb(0);
    }
    // Features that are not finite become 0: filters that are led by features would spread them.
    for (Rgb* albedo : {&s.albedo, &s.features.albedo})
        if (!is_finite(*albedo)) *albedo = Rgb(0);
    for (Vec3* normal : {&s.normal, &s.features.normal})
        if (!is_finite(*normal)) *normal = {};
    if (!std::isfinite(s.opacity)) s.opacity = 0;
    if (!std::isfinite(s.depth) || !std::isfinite(s.features.depth)) s.hit = false;
    film.add(pixel, s);
}

/// The beginning of a sample's path.
struct CameraPath {
    Vec2 film, lens;
    float time = 0;
    CameraRay ray;
    Sampler sampler;
    float weight = 1;  ///< of the place in the pixel, by its filter
};

CameraPath begin_path(const PassContext& context, int x, int y, uint32_t index) {
    Sampler sampler(context.seed, x, y, context.sequence_index(index));
    const Sampler::CameraSample u = context.scene.has_lens_or_motion
                                        ? sampler.camera()
                                        : Sampler::CameraSample{sampler.film(), {}, 0};
    const PixelFilter::Sample position = context.scene.filter.sample(u.film);
    const Vec2 film{float(x) + 0.5f + position.offset.x, float(y) + 0.5f + position.offset.y};
    CameraRay ray = context.scene.camera.generate_ray(film, u.lens, u.time);
    ray.sample =
        static_cast<uint32_t>(hash_combine(context.seed, uint64_t(x), uint64_t(y), index) >> 32);
    return {film, u.lens, u.time, ray, sampler, position.weight};
}

Rgb product(const std::array<std::array<float, 3>, 3>& matrix, Rgb c) {
    const auto channel = [&](size_t i) {
        return matrix[i][0] * c.r + matrix[i][1] * c.g + matrix[i][2] * c.b;
    };
    return {channel(0), channel(1), channel(2)};
}

/// Makes a sample for the film from a path.
FilmSample film_sample(const PassContext& context, const CameraPath& start,
                       const PathResult& path) {
    FilmSample s;
    s.rays = uint32_t(path.rays.total());
    const auto exposed = [&](Rgb c) {
        return product(context.sensor, c * (start.ray.weight * context.imaging_scale));
    };
    s.radiance = exposed(path.radiance);
    s.in_view = exposed(path.in_view);
    const float largest = max_component(product(context.sensor_values, s.radiance));
    const float limit = largest > context.max_component ? context.max_component / largest : 1.0f;
    s.radiance *= limit;
    s.in_view *= limit;
    s.weight = start.weight;
    s.albedo = path.albedo;
    s.normal = path.normal;
    s.depth = path.depth;
    s.hit = path.hit;
    s.opacity = path.opacity;
    s.features = path.features;
    if (context.surfaces != FilmDescription::Surfaces::none)
        s.surface = first_surface(
            context.scene, context.surfaces, start.ray,
            context.scene.camera.rays_beside(start.film, start.lens, start.time), path);
    return s;
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

FilmSample take_sample(const PassContext& context, int x, int y, uint32_t index, PathRecord* record,
                       PathResult& path) {
    const CameraPath start = begin_path(context, x, y, index);
    path = {};
    if (start.ray.sees) {
        path = trace_path(context.scene, start.ray, start.sampler, context.max_depth, record);
    } else if (record) {
        record->clear();
        record->camera_ray = start.ray;
        record->last_way = 0;  // the place on the film sees nothing along its ray
    }
    return film_sample(context, start, path);
}

namespace {

/// Takes samples of a tile by batches of paths.
class BatchSampler {
  public:
    BatchSampler(const PassContext& context, Film& film, Stop& stop, PassStatistics& statistics)
        : context_(context), film_(film), stop_(stop), statistics_(statistics) {}

    /// Takes the tile's samples up to `counts`; returns false where it was stopped.
    bool take(const PixelBounds& tile, std::span<const uint32_t> counts) {
        for (int y = tile.y0; y < tile.y1; ++y)
            for (int x = tile.x0; x < tile.x1; ++x) {
                const size_t pixel = film_.index(x, y);
                for (uint32_t i = film_.pixels[pixel].count; i < counts[pixel]; ++i) {
                    const CameraPath start = begin_path(context_, x, y, i);
                    places_.push_back({pixel, x, y, start, batch_.size()});
                    if (start.ray.sees) batch_.add(start.ray, start.sampler);
                    if (places_.size() == PathBatch::kMost && !trace()) return false;
                }
            }
        return trace();
    }

  private:
    struct Place {
        size_t pixel;
        int x, y;
        CameraPath start;
        size_t path;  // number in the batch, of places that see anything
    };

    bool trace() {
        const auto stops = [this] {
            stop_.look_at_clock();
            return stop_();
        };
        if (!batch_.trace(stops)) return false;
        for (const Place& p : places_) {
            const PathResult& path = p.start.ray.sees ? batch_.result(p.path) : nothing_;
            add_sample(context_, film_, p.pixel, p.x, p.y, path,
                       film_sample(context_, p.start, path), statistics_);
        }
        if (!places_.empty()) stop_.took_samples();
        batch_.clear();
        places_.clear();
        return true;
    }

    const PassContext& context_;
    Film& film_;
    Stop& stop_;
    PassStatistics& statistics_;
    PathBatch batch_{context_.scene, context_.max_depth};
    std::vector<Place> places_;
    const PathResult nothing_;
};

}  // namespace

PassStatistics radiance_pass(const PassContext& context, Film& film,
                             std::span<const uint32_t> counts, const Monitor& monitor,
                             const PassProgress& progress) {
    return for_each_tile(
        context, film, monitor, progress,
        [&](const PixelBounds& tile, Stop& stop, PassStatistics& statistics) {
            return BatchSampler(context, film, stop, statistics).take(tile, counts);
        });
}

namespace {

/// Whether the path found an emitter, or a sky, that is in view.
bool shows_emitter(const PathRecord& record) {
    if (record.escaped > 0 && record.escape_in_view) return true;
    for (int i = 0; i < record.count; ++i) {
        const PathVertex& v = record.vertices[size_t(i)];
        if (!v.in_view) return false;  // nor is any after it
        if (v.emitted > 0) return true;
    }
    return false;
}

/// The film's rim around a tile and as far beyond it as pixel filters commonly reach.
FilmRim rim_near(const Camera& camera, const PixelBounds& tile) {
    constexpr float kMargin = 8;  // pixels
    return {camera,
            {float(tile.x0) - kMargin, float(tile.y0) - kMargin},
            {float(tile.x1) + kMargin, float(tile.y1) + kMargin}};
}

/// A path's covariance at a place of the film from which `way` leads to the film's rim, whose edge
/// it has, too.
PathCovariance beside_rim(PathCovariance path, const std::optional<Vec2>& way) {
    constexpr float kNearest = 0.1f;  // pixels
    if (!way || !(path.weight > 0)) return path;
    const float d = length(*way);
    if (d > 0)
        path.sigma = covariance::occlude(path.sigma, double(way->x / d), double(way->y / d),
                                         double(std::max(d, kNearest)));
    return path;
}

/// Adds a path's covariance to `mean`, the mean of `paths` paths before it. Its weight is cut to
/// `weight_limit`.
void add_path(PackedCovariance& mean, uint32_t paths, const PathCovariance& path,
              double weight_limit) {
    covariance::Accumulator<double> sum;
    sum.add(mean.covariance(), double(mean.weight) * paths);
    sum.add(path.sigma, std::min(path.weight, weight_limit));
    mean = {sum.mean(), float(sum.weight() / (paths + 1.0))};
}

}  // namespace

PassStatistics covariance_pass(const PassContext& context, const PathReplay& replay, Film& film,
                               std::span<const uint32_t> counts, const CovarianceTarget& target,
                               const Monitor& monitor, const PassProgress& progress) {
    const auto take = [&](size_t i, int x, int y, const FilmRim& rim, PassStatistics& statistics) {
        static thread_local PathRecord record;
        const uint32_t index = film.pixels[i].count;
        const uint32_t paths = index + (target.earlier.empty() ? 0 : target.earlier[i]);
        PathResult path;
        const FilmSample s = take_sample(context, x, y, index, &record, path);
        add_sample(context, film, i, x, y, path, s, statistics);
        const Stopwatch watch(statistics.replay_seconds);
        std::optional<Vec2> to_rim;
        if (rim.is_there()) to_rim = rim.way(begin_path(context, x, y, index).film);
        add_path(target.buffers.scattered[i], paths,
                 beside_rim(replay(record, LightPart::scattered), to_rim), target.weight_limit);
        const PathCovariance in_view =
            shows_emitter(record) ? replay(record, LightPart::in_view) : PathCovariance{};
        add_path(target.buffers.in_view[i], paths, beside_rim(in_view, to_rim), kInfinity);
    };
    return for_each_tile(context, film, monitor, progress,
                         [&](const PixelBounds& tile, Stop& stop, PassStatistics& statistics) {
                             // Rays traced between looks at the clock. Samples are no measure: one
                             // takes a single ray or, where it meets many interfaces of media,
                             // thousands.
                             constexpr uint64_t kRaysBetweenLooks = 256;
                             uint64_t look_at = 0;
                             const FilmRim rim = rim_near(context.scene.camera, tile);
                             for (int y = tile.y0; y < tile.y1; ++y)
                                 for (int x = tile.x0; x < tile.x1; ++x) {
                                     const size_t i = film.index(x, y);
                                     while (film.pixels[i].count < counts[i]) {
                                         if (stop()) return false;
                                         take(i, x, y, rim, statistics);
                                         stop.took_samples();
                                         const uint64_t rays = statistics.rays.total();
                                         if (rays < look_at) continue;
                                         stop.look_at_clock();
                                         look_at = rays + kRaysBetweenLooks;
                                     }
                                 }
                             return true;
                         });
}

double limit_weights(const Film& film, CovarianceBuffers& buffers) {
    constexpr double kMost = 10;  // weight of one path, as a multiple of the mean over all paths
    double sum = 0, paths = 0;
    for (size_t i = 0; i < film.pixels.size(); ++i) {
        sum += buffers.scattered[i].weight;
        paths += film.pixels[i].count;
    }
    if (paths == 0) return kInfinity;
    const double limit = kMost * sum / paths;
    for (PackedCovariance& mean : buffers.scattered)
        mean.weight = float(std::min(double(mean.weight), limit));
    return limit;
}

}  // namespace covtrace
