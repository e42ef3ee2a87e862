/// Passes over the image: radiance samples by count, and the covariance paths.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "frequency/brdf_covariance.h"
#include "frequency/occlusion.h"
#include "integrator/path.h"
#include "integrator/render_scene.h"
#include "planner/covariance_buffer.h"
#include "render/film.h"
#include "render/progress.h"

namespace covtrace {

/// A sample whose value was not a finite number; it counted as black.
struct RejectedSample {
    int x = 0, y = 0;
    uint32_t sample = 0;
};

/// Sums over all samples of a render.
struct PassStatistics {
    static constexpr size_t kLengths = 33;
    uint64_t samples = 0, vertices = 0;
    RayCounts rays;
    /// Paths by their number of vertices, emitters at the end included; the last counts all that
    /// are as long or longer.
    std::array<uint64_t, kLengths> lengths{};
    uint64_t black_paths = 0;  ///< without any light
    uint64_t rejected = 0;
    std::vector<RejectedSample> first_rejected;  ///< at most a few, in image order
    /// Of all threads together: on samples and all that is made of them, and of these on the
    /// replay of recorded paths.
    double seconds = 0, replay_seconds = 0;
    void add(const PassStatistics& other);
};

/// What every pass shares. `imaging_scale` and `max_component` turn radiance into film values as
/// pbrt does: exposure time times iso / 100, then a limit on the largest component.
struct PassContext {
    const RenderScene& scene;
    uint64_t seed = 0;
    int max_depth = 5;
    float imaging_scale = 1, max_component = kInfinity;
    std::array<std::array<float, 3>, 3> white_balance{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
};

/// Called from worker threads with the share of the pass that is done.
using PassProgress = std::function<void(double)>;

/// Takes `count(pixel index)` more samples in every pixel. One thread owns a pixel and adds its
/// samples in index order. Returns early, with whole tiles done, once the monitor is cancelled.
PassStatistics radiance_pass(const PassContext& context, Film& film,
                             std::span<const uint32_t> counts, const Monitor& monitor,
                             const PassProgress& progress);

/// The same with `counts` paths per pixel that also leave their covariance. Weights of scattered
/// light are limited to ten times the mean of the image's first paths, so that no single path owns
/// a pixel.
PassStatistics covariance_pass(const PassContext& context, const Occluders& occluders,
                               BrdfCovariance rule, Film& film, std::span<const uint32_t> counts,
                               CovarianceBuffers& buffers, const Monitor& monitor,
                               const PassProgress& progress);

/// One sample as the passes take it, for replaying a pixel: returns the path and the film's sample.
FilmPixel::Sample take_sample(const PassContext& context, int x, int y, uint32_t index,
                              PathRecord* record, PathResult& path);

}  // namespace covtrace
