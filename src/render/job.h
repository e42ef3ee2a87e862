/// The part of a render that all methods share: the scene, the budget, the clock and the progress.
#pragma once

#include <optional>

#include "render/keeping.h"
#include "render/phase_timer.h"
#include "render/render_result.h"
#include "render/render_state.h"

namespace covtrace {

/// The context that all passes of a render share.
PassContext pass_context(const RenderScene& scene, const RenderOptions& options);
/// The context of the passes of half k of `hybrid`.
PassContext half_context(const PassContext& whole, uint32_t k);

class RenderJob {
  public:
    /// Begins the render, or goes on from the film that `keeping` holds. Throws Error(usage) where
    /// that is a film of another render.
    RenderJob(const RenderScene& scene, const RenderOptions& options, Monitor& monitor,
              FilmKeeping keeping = {});

    const RenderScene& scene;
    const RenderOptions& options;
    Monitor& monitor;
    const FilmKeeping keeping;
    RenderState state;
    const PixelBounds region;  ///< the pixels to render
    PassContext context;
    RenderResult result;
    /// Average count asked for; none: time or error alone decide.
    const std::optional<double> target_spp;
    /// The average count at which the error, or every pixel's count, will be as asked for, as far
    /// as is known yet.
    std::optional<double> enough;

    /// The tiles that this process traces.
    Shard tiles() const;
    /// Whether this process makes the image.
    bool delivers() const;
    double& seconds(Phase phase) { return result.statistics.seconds[phase]; }
    int64_t pixels() const { return int64_t(region.width()) * region.height(); }

    /// A reporter for a pass that takes the average count from `from` to `to`.
    PassProgress reporter(Phase phase, double from, double to);
    /// Share of the tracing that is done at an average of `spp`, in [0, kTracingShare].
    double fraction(double spp) const;

    /// The average count to trace up to next, given where the round would end; the count that is
    /// taken already where the budget is spent.
    double plan_round(double round_end) const;
    /// The second at which tracing must end for the rest to be done in time; infinite without a
    /// budget of time.
    double tracing_end() const;
    /// The second at which a round ends that takes longer than was planned, or that was not planned
    /// by the clock, as the first rounds, which an image needs.
    double latest_end() const;
    /// The most samples of any pixel in a round up to an average of `target`.
    double most_samples(double target) const;
    /// Begins a round. `plan`: for each film, the samples that each pixel has at the round's end.
    /// Returns false, and begins none, where all pixels have them already.
    bool begin_round(double target, std::vector<std::vector<uint32_t>> plan);
    /// Counts that are the same in every pixel, as near as whole samples allow.
    std::vector<uint32_t> even_counts(double spp) const;
    /// Adds the counters of a pass to the sums of its kind.
    void counted(PassStatistics& sum, const PassStatistics& pass);
    /// Puts the memory of the state into the statistics, where that is the most it ever held.
    void note_memory();
    /// Keeps `seconds` for all that follows the last sample, beside the writing.
    void reserve(double seconds) { reserve_ = kWriteSeconds + seconds; }

    /// Share of tracing in the progress bar; the rest is reconstruction and output.
    static constexpr double kTracingShare = 0.97;

  private:
    /// Rough seconds that the last writing of the film takes.
    double keeping_seconds() const;

    static constexpr double kWriteSeconds = 0.1;
    size_t most_memory_ = 0;
    double reserve_ = kWriteSeconds;
};

}  // namespace covtrace
