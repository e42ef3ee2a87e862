/// What becomes of the film of a render: where it begins, and when it is kept.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>

#include "render/shard.h"

namespace covtrace {

class Ranks;
struct RenderState;

/// Why a film is kept.
enum class KeepReason {
    checkpoint,  ///< the render goes on
    interrupted,
    done  ///< the budget is spent, or this shard's part of the round
};

struct FilmKeeping {
    std::shared_ptr<const RenderState> from;  ///< goes on from here; null: from the start
    std::string name;                         ///< of the file that it is from, for messages
    /// Keeps the film, where there is one.
    std::function<void(const RenderState&, KeepReason)> keep;
    /// Seconds between checkpoints; they are further apart where keeping would take more than
    /// `most_share` of the time.
    double interval = std::numeric_limits<double>::infinity();
    double most_share = 1;
    Shard shard;                   ///< the tiles to trace
    const Ranks* ranks = nullptr;  ///< other processes that trace tiles of the same render
    /// What this shard has of the round already, if it is of this round; null: nothing.
    std::shared_ptr<const RenderState> part;
};

}  // namespace covtrace
