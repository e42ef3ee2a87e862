#include "render/rounds.h"

#include <algorithm>
#include <cmath>

#include "render/develop.h"
#include "render/ranks.h"
#include "render/round.h"

namespace covtrace {

namespace {

/// Keeps the film when it is time, and makes passes end for it.
class Checkpoints {
  public:
    /// Begins with the round in progress, if there is one. A round that another process began was
    /// not planned for this process's time: it ends early where that time is over.
    explicit Checkpoints(RenderJob& job)
        : job_(job), deadline_(job.state.in_round() ? job.tracing_end() : kInfinity) {
        schedule(0);
    }
    ~Checkpoints() { job_.monitor.pause_at(kInfinity); }
    Checkpoints(const Checkpoints&) = delete;
    Checkpoints& operator=(const Checkpoints&) = delete;

    bool out_of_time() const { return job_.monitor.elapsed() >= deadline_; }
    void round_begins() {
        deadline_ = job_.latest_end();
        schedule(0);
    }

    void keep(KeepReason reason) {
        const double start = job_.monitor.elapsed();
        if (job_.keeping.keep) {
            const PhaseTimer timer(job_.monitor, job_.seconds(Phase::checkpoint));
            job_.keeping.keep(job_.state, reason);
        }
        schedule(job_.monitor.elapsed() - start);
    }

  private:
    void schedule(double cost) {
        double wait = std::max(job_.keeping.interval, cost / job_.keeping.most_share);
        // The first process writes for all, and alone knows the cost; all processes are to pause
        // together.
        if (const Ranks* ranks = job_.keeping.ranks) wait = ranks->of_first(wait);
        job_.monitor.pause_at(std::min(deadline_, job_.monitor.elapsed() + wait));
    }
    RenderJob& job_;
    double deadline_;
};

/// Whether a film is the part of this round and shard that another process left.
bool is_same_part(const RenderState& part, const RenderState& s) {
    return !difference(part.identity, s.identity) && part.shards == s.shards &&
           part.present == s.present && part.stage == s.stage && part.taken == s.taken &&
           part.target == s.target && part.plan == s.plan;
}

/// Drops the pixels of other shards: once the plan is made, from all pixels, a shard needs its own
/// alone.
void begin_shard(RenderJob& job) {
    const Shard& shard = job.keeping.shard;
    if (shard.is_all()) return;
    RenderState& s = job.state;
    s.shards = shard.count;
    s.present = {shard.index};
    s.keep_only(shard);
    if (shard.index > 0) {  // the samples counted before the shards count once
        s.rejected = 0;
        s.first_rejected.clear();
    }
    if (s.in_round() && job.keeping.part && is_same_part(*job.keeping.part, s)) {
        const std::optional<double> budget = s.spp;  // the budget may have grown since
        s = *job.keeping.part;
        s.spp = budget;
    }
}

void report(RenderJob& job) {
    RenderState& s = job.state;
    if (s.films.size() == 1) {
        job.monitor.set_error(estimated_error(s.films[0]));
        if (job.monitor.watched()) show_round(job.monitor, s.films[0], s.display, s.has_holes);
    } else if (job.monitor.watched()) {
        // Raw pixels are shown, but their error is not told: it says nothing of an image made from
        // halves.
        show_round(job.monitor, whole_film(s), s.display, s.has_holes);
    }
}

/// Traces the round in progress, in this process and in all that take part.
void trace(RenderJob& job, const Rounds& rounds) {
    RenderState& s = job.state;
    const double start = job.monitor.elapsed(), before = s.mean_count();
    const uint64_t rejected = s.rejected;
    rounds.trace();
    if (const Ranks* ranks = job.keeping.ranks) {
        ranks->share_pixels(s);
        s.rejected = rejected + ranks->sum(s.rejected - rejected);
    }
    const double gained = s.mean_count() - before;
    // The first paths are analysed, too: they do not tell how long others take.
    if (s.stage == Stage::pilot && gained > 0) s.seconds = s.seconds_spp = 0;
    s.seconds += job.monitor.elapsed() - start;
    s.seconds_spp += gained;
}

/// Whether the first rounds did not come to their end, or a pixel has no sample.
bool lacks_samples(const RenderState& s) {
    if (s.stage != Stage::rounds) return true;
    const auto& pixels = s.films[0].pixels;
    return s.films.size() == 1 && std::any_of(pixels.begin(), pixels.end(),
                                              [](const FilmPixel& p) { return p.count == 0; });
}

}  // namespace

double round_end(double taken) {
    double end = 1;
    while (end <= taken) end *= 2;
    return end;
}

void trace_rounds(RenderJob& job, const Rounds& rounds) {
    RenderState& s = job.state;
    const Ranks* ranks = job.keeping.ranks;
    const auto for_any = [ranks](bool v) { return ranks ? ranks->any(v) : v; };
    Checkpoints checkpoints(job);
    if (s.in_round()) begin_shard(job);
    while (true) {
        // Plan the next round
        if (!s.in_round()) {
            if (for_any(job.monitor.cancelled())) break;
            s.complete = !rounds.plan();
            begin_shard(job);
            if (s.complete) break;
            checkpoints.round_begins();
        }
        // Take its samples; a pause keeps the film, and the round goes on
        trace(job, rounds);
        if (!s.reached(job.keeping.shard)) {
            s.complete = for_any(checkpoints.out_of_time());
            job.result.is_below_least = s.complete && lacks_samples(s);
            if (for_any(job.monitor.cancelled()) || s.complete) break;
            checkpoints.keep(KeepReason::checkpoint);
            continue;
        }
        // Draw the conclusions of a whole round
        job.note_memory();
        if (!job.keeping.shard.is_all()) break;
        const bool of_rounds = s.stage == Stage::rounds;
        finish_round(s);
        if (of_rounds) report(job);
    }
    // Keep the film, unless it has no samples: an older film is worth more.
    if (!job.monitor.cancelled() || s.mean_count() > 0)
        checkpoints.keep(job.monitor.cancelled() && !s.complete ? KeepReason::interrupted
                                                                : KeepReason::done);
    job.note_memory();
    job.result.statistics.samples_per_pixel = s.mean_count();
    job.result.statistics.rejected = s.rejected;
    job.result.statistics.first_rejected = s.first_rejected;
}

}  // namespace covtrace
