#include "render/methods/uniform.h"

#include <algorithm>
#include <cmath>

#include "core/vec.h"
#include "planner/density.h"
#include "render/develop.h"
#include "render/round.h"
#include "render/rounds.h"

namespace covtrace {

namespace {

/// The count at which the next round ends. Every pixel gets the same: rounds only serve those who
/// watch, and budgets of time and error.
double next_round(double taken) {
    return std::max(taken + 1, std::floor(taken * 1.5));
}

bool plan_uniform(RenderJob& job) {
    const RenderState& s = job.state;
    const Film& film = s.films[0];
    if (job.options.error) {
        const double error = estimated_error(film);
        if (s.taken >= kLeastForError && error < *job.options.error) return false;
        // The estimate is not a number as long as the error is not known.
        if (const double enough = s.taken * sqr(error / *job.options.error); std::isfinite(enough))
            job.enough = std::max(kLeastForError, enough);
    }
    const bool alone = job.keeping.shard.is_all();
    const double target = job.plan_round(alone ? next_round(s.taken) : *job.target_spp);
    if (!(target > s.taken)) return false;
    std::vector<uint32_t> have(film.pixels.size());
    for (size_t i = 0; i < have.size(); ++i) have[i] = film.pixels[i].count;
    const std::vector<float> even(have.size(), 1.0f);
    return job.begin_round(target,
                           {allocate(even, std::llround(target * double(job.pixels())), have,
                                     uint32_t(std::clamp(job.most_samples(target), 1.0, 4e9)))});
}

}  // namespace

void render_uniform(RenderJob& job) {
    RenderState& s = job.state;
    trace_rounds(job, {[&] { return plan_uniform(job); },
                       [&] {
                           const PhaseTimer timer(job.monitor, job.seconds(Phase::radiance));
                           job.counted(
                               job.result.statistics.radiance,
                               radiance_pass(job.context, s.films[0], s.plan[0], job.monitor,
                                             job.reporter(Phase::radiance, s.taken, s.target)));
                       }});
    if (job.delivers()) job.result.image = develop(s);
}

}  // namespace covtrace
