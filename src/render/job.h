/// What the methods share: the scene, the budget, the clock and the progress of one render.
#pragma once

#include <functional>
#include <optional>

#include "render/session.h"

namespace covtrace {

/// Adds the seconds that a scope took to a phase.
class PhaseTimer {
  public:
    PhaseTimer(const Monitor& monitor, double& total)
        : monitor_(monitor), total_(total), start_(monitor.elapsed()) {}
    ~PhaseTimer() { total_ += monitor_.elapsed() - start_; }
    PhaseTimer(const PhaseTimer&) = delete;
    PhaseTimer& operator=(const PhaseTimer&) = delete;

  private:
    const Monitor& monitor_;
    double& total_;
    const double start_;
};

class RenderJob {
  public:
    RenderJob(RenderScene& scene, const RenderOptions& options, Monitor& monitor);

    RenderScene& scene;
    const RenderOptions& options;
    Monitor& monitor;
    const PixelBounds region;   ///< the pixels to render
    const PixelBounds display;  ///< the full frame
    PassContext context;
    RenderResult result;
    std::optional<double> target_spp;  ///< none: the time alone decides

    double& phase(const char* name) { return result.statistics.seconds[name]; }
    int64_t pixels() const { return int64_t(region.width()) * region.height(); }

    /// A reporter for a pass that takes the average count from `from` to `to`.
    PassProgress reporter(const char* name, double from, double to);
    /// Share of the tracing that is done at an average of `spp`, in [0, kTracingShare].
    double fraction(double spp) const;

    /// The average to trace up to next, given what is taken and where the round would end; equal to
    /// `taken` where the budget is spent.
    double plan_round(double taken, double round_end) const;
    /// Tells what tracing cost: `spp` samples per pixel in `seconds`.
    void traced(double spp, double seconds);
    /// Seconds to keep for all that follows the last sample, beside the writing.
    void reserve(double seconds) { reserve_ = kWriteSeconds + seconds; }

    /// Of the progress bar; the rest is reconstruction and output.
    static constexpr double kTracingShare = 0.97;

  private:
    static constexpr double kWriteSeconds = 0.1;
    double traced_seconds_ = 0, traced_spp_ = 0;  // so far: what a sample per pixel costs
    double reserve_ = kWriteSeconds;
};

/// What the frequency analysis learns of occluders from, as the options ask.
class SceneOccluders {
  public:
    explicit SceneOccluders(RenderJob& job);
    /// Valid while this lives.
    Occluders view() const { return {grid_ ? &*grid_ : nullptr, query_ ? &*query_ : nullptr}; }

  private:
    std::optional<VoxelGrid> grid_;
    std::optional<OccluderQuery> query_;
};

/// The three methods. Each leaves image and statistics in the job's result.
void render_uniform(RenderJob& job);
void render_covariance(RenderJob& job);
void render_hybrid(RenderJob& job);

}  // namespace covtrace
