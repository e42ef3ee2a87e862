/// The rounds that every method is made of: plan, trace, keep the film, tell of it.
#pragma once

#include <functional>

#include "render/job.h"

namespace covtrace {

/// The parts of a round that differ between methods.
struct Rounds {
    std::function<bool()> plan;   ///< begins the next round; false: the budget is spent
    std::function<void()> trace;  ///< takes samples of the round, until the monitor ends it
};
/// Traces rounds from where the job's state stands until the budget is spent, the monitor is
/// cancelled or, for a shard, the other shards' samples are needed. Keeps the film as the job asks.
void trace_rounds(RenderJob& job, const Rounds& rounds);

/// End of the round that begins at an average of `taken`: rounds double the total, whatever the
/// budget.
double round_end(double taken);

}  // namespace covtrace
