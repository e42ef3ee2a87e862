/// Joining the films of shards.
#pragma once

#include <string>

#include "render/render_state.h"

namespace covtrace {

/// Collects the films of the shards of one render, in any order, with the same result for all.
class FilmMerge {
  public:
    /// Adds a film, called `name` in messages. Throws Error(usage) for a film of another render, of
    /// another round, or with a shard that is there already.
    void add(const std::string& name, RenderState film);

    /// The sum of all films that were added, at least one. Where every shard is there it is the
    /// film that one machine would have made, and the round is finished.
    RenderState result() &&;

  private:
    std::string first_name_;
    std::optional<RenderState> sum_;
};

/// The reason why the image of a film that is not complete is not.
std::string missing_part(const RenderState& state);

}  // namespace covtrace
