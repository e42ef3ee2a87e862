/// Keeping a film: where a render begins, and when its film is written.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>

#include "render/shard.h"

namespace covtrace {

class Ranks;
struct RenderState;

/// Reason why a film is kept.
enum class KeepReason {
    checkpoint,  ///< the render goes on
    interrupted,
    done  ///< the budget is spent, or this shard's part of the round
};

struct FilmKeeping {
    std::shared_ptr<const RenderState> from;  ///< film to go on from; null: from the start
    std::string name;                         ///< name of the file of `from`, for messages
    /// Writes the film; empty where no film is kept.
    std::function<void(const RenderState&, KeepReason)> keep;
    /// Seconds between checkpoints; they are further apart where keeping would take more than
    /// `most_share` of the time.
    double interval = std::numeric_limits<double>::infinity();
    double most_share = 1;
    Shard shard;                   ///< the tiles to trace
    const Ranks* ranks = nullptr;  ///< other processes that trace tiles of the same render
    /// The film that this shard has of the round already, if it is of this round; null: none.
    std::shared_ptr<const RenderState> part;
};

}  // namespace covtrace
