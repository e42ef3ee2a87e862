/// Passes over the image: radiance samples by count, and the covariance paths.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "frequency/replay.h"
#include "integrator/path.h"
#include "integrator/render_scene.h"
#include "prediction/covariance_buffer.h"
#include "render/film.h"
#include "render/hybrid_film.h"
#include "render/progress.h"
#include "render/shard.h"

namespace covtrace {

/// A sample whose value was not a finite number; it counts as black.
struct RejectedSample {
    int x = 0, y = 0;
    uint64_t sample = 0;  ///< as PassContext::sample_name
};

/// Sums over all samples of a render.
struct PassStatistics {
    static constexpr size_t kLengths = 33, kMostRejectedKept = 8;
    uint64_t samples = 0, vertices = 0;
    RayCounts rays;
    /// Number of paths by their number of vertices, emitters at the end included; the last entry
    /// counts all paths that are as long or longer.
    std::array<uint64_t, kLengths> lengths{};
    uint64_t black_paths = 0;  ///< paths without any light
    uint64_t rejected = 0;
    std::vector<RejectedSample> first_rejected;  ///< at most a few, in image order
    /// Time of all threads together: `seconds` on samples and all that is made of them, and
    /// `replay_seconds`, a part of it, on the replay of recorded paths.
    double seconds = 0, replay_seconds = 0;
    void add(const PassStatistics& other);
};

/// Settings that every pass shares. `imaging_scale` and `max_component` turn radiance into film
/// values as pbrt does: exposure time times iso / 100, then a limit on the largest of the sensor's
/// values.
struct PassContext {
    const RenderScene& scene;
    uint64_t seed = 0;
    int max_depth = 5;
    float imaging_scale = 1, max_component = kInfinity;
    std::array<std::array<float, 3>, 3> sensor{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    std::array<std::array<float, 3>, 3> sensor_values{};                   ///< as FilmDescription's
    FilmDescription::Surfaces surfaces = FilmDescription::Surfaces::none;  ///< FilmSample::surface
    Shard shard = {};                                                      ///< the tiles to trace
    uint32_t half = 0, halves = 1;

    /// Number by which people name a sample: the halves take turns, so that one number finds it
    /// again.
    uint64_t sample_name(uint32_t index) const { return uint64_t(index) * halves + half; }
    /// Index of a sample in the sequence of its pixel.
    uint32_t sequence_index(uint32_t index) const {
        return halves == 1 ? index : place_in_sequence(half, index);
    }
};

/// Progress of a pass: called from worker threads with the share that is done.
using PassProgress = std::function<void(double)>;

/// Takes samples up to `counts`, one number per pixel, in every pixel of the context's tiles. One
/// thread owns a pixel and adds its samples in index order. Returns early once the monitor is
/// cancelled or its pause is due: between any two samples, so that calling it again goes on to the
/// same bits.
PassStatistics radiance_pass(const PassContext& context, Film& film,
                             std::span<const uint32_t> counts, const Monitor& monitor,
                             const PassProgress& progress);

/// The paths of a covariance pass and where their covariances go.
struct CovarianceTarget {
    CovarianceBuffers& buffers;         ///< means over the paths so far
    std::span<const uint32_t> earlier;  ///< paths of each pixel that other films took; may be empty
    double weight_limit = kInfinity;    ///< limit for scattered light, see limit_weights
};

/// Takes samples as radiance_pass does, by paths that also leave their covariances. All samples
/// that the film has so far are such paths.
PassStatistics covariance_pass(const PassContext& context, const PathReplay& replay, Film& film,
                               std::span<const uint32_t> counts, const CovarianceTarget& target,
                               const Monitor& monitor, const PassProgress& progress);

/// Limits the weights of scattered light to ten times the mean of the image's first paths, so that
/// no single path owns a pixel; to be called when `film` has at most one path in every pixel, which
/// are all that `buffers` know. Returns the limit for the paths to come.
double limit_weights(const Film& film, CovarianceBuffers& buffers);

/// One sample as the passes take it, for replaying a pixel: returns the path and the film's sample.
FilmSample take_sample(const PassContext& context, int x, int y, uint32_t index, PathRecord* record,
                       PathResult& path);

}  // namespace covtrace
