/// What the methods share: the scene, the budget, the clock and the progress of one render.
#pragma once

#include <functional>
#include <optional>

#include "render/keeping.h"
#include "render/render_state.h"
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

/// What the passes of a render share.
PassContext pass_context(const RenderScene& scene, const RenderOptions& options);
/// The same for half k of `hybrid`.
PassContext half_context(const PassContext& whole, uint32_t k);

class RenderJob {
  public:
    /// Throws Error(usage) where `keeping` holds a film of another render.
    RenderJob(RenderScene& scene, const RenderOptions& options, Monitor& monitor,
              FilmKeeping keeping = {});

    RenderScene& scene;
    const RenderOptions& options;
    Monitor& monitor;
    const FilmKeeping keeping;
    RenderState state;
    const PixelBounds region;  ///< the pixels to render
    PassContext context;
    RenderResult result;
    const std::optional<double> target_spp;  ///< none: time or error alone decide
    /// The average at which the error, or every pixel's count, will be as asked for, by what is
    /// known of it.
    std::optional<double> enough;

    /// The tiles that this process traces.
    Shard tiles() const;
    /// Whether this process makes the image.
    bool delivers() const;
    double& phase(const char* name) { return result.statistics.seconds[name]; }
    int64_t pixels() const { return int64_t(region.width()) * region.height(); }

    /// A reporter for a pass that takes the average count from `from` to `to`.
    PassProgress reporter(const char* name, double from, double to);
    /// Share of the tracing that is done at an average of `spp`, in [0, kTracingShare].
    double fraction(double spp) const;

    /// The average to trace up to next, given where the round would end; what is taken already
    /// where the budget is spent.
    double plan_round(double round_end) const;
    /// When tracing must end for the rest to be done in time; infinite without a budget of time.
    double tracing_end() const;
    /// When a round ends that takes longer than was planned, or that was not planned by the clock:
    /// the first ones, which an image needs.
    double latest_end() const;
    /// Whether what takes no samples has to end now.
    bool out_of_time() const { return monitor.cancelled() || monitor.elapsed() >= latest_end(); }
    /// The most samples of any pixel in a round up to an average of `target`.
    double most_samples(double target) const;
    /// Begins a round: how many samples each pixel, of each film, has at its end. False, and no
    /// round, where all have them already.
    bool begin_round(double target, std::vector<std::vector<uint32_t>> plan);
    /// The same count, as near as whole samples allow, in every pixel.
    std::vector<uint32_t> even_counts(double spp) const;
    /// Adds what a pass counted to the sums of its kind.
    void counted(PassStatistics& sum, const PassStatistics& pass);
    /// Puts what the state holds now into the statistics, where that is the most it ever held.
    void note_memory();
    /// Seconds to keep for all that follows the last sample, beside the writing.
    void reserve(double seconds) { reserve_ = kWriteSeconds + seconds; }

    /// Of the progress bar; the rest is reconstruction and output.
    static constexpr double kTracingShare = 0.97;

  private:
    /// About what the last writing of the film takes.
    double keeping_seconds() const;

    static constexpr double kWriteSeconds = 0.1;
    size_t most_memory_ = 0;
    double reserve_ = kWriteSeconds;
};

/// What the frequency analysis learns of occluders from, as the options ask.
class SceneOccluders {
  public:
    explicit SceneOccluders(RenderJob& job);
    /// Valid while this lives.
    Occluders view() const {
        return {grid_ ? &*grid_ : nullptr, query_ ? &*query_ : nullptr, every_voxel_};
    }

  private:
    std::optional<VoxelGrid> grid_;
    std::optional<OccluderQuery> query_;
    bool every_voxel_ = false;
};

/// What a method does in its rounds.
struct Rounds {
    std::function<bool()> plan;   ///< begins the next round; false: the budget is spent
    std::function<void()> trace;  ///< takes samples of the round, until the monitor ends it
};
/// Goes on from where the job's state stands until the budget is spent, the monitor is cancelled
/// or, for a shard, the other shards' samples are needed. Keeps the film as the job asks.
void trace_rounds(RenderJob& job, const Rounds& rounds);

/// The end of the round after an average of `taken`: rounds double the total, whatever the budget.
double round_end(double taken);

/// The three methods. Each leaves image, unless it is only a shard's, and statistics in the job's
/// result.
void render_uniform(RenderJob& job);
void render_covariance(RenderJob& job);
void render_hybrid(RenderJob& job);

}  // namespace covtrace
