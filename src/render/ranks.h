/// Several processes that render one image together.
#pragma once

#include <cstdint>
#include <vector>

namespace covtrace {

struct RenderState;

/// Communication between the processes of a render. Each function is to be called by all processes,
/// in the same order.
class Ranks {
  public:
    virtual ~Ranks() = default;
    virtual int index() const = 0;  ///< index of this process, from 0
    virtual int count() const = 0;
    /// The value of the first process, for all.
    virtual double of_first(double value) const = 0;
    virtual bool any(bool value) const = 0;
    virtual uint64_t sum(uint64_t value) const = 0;
    /// Ends all processes at once with this exit code: one that failed can't let the others wait.
    virtual void abort(int code) const = 0;
    /// Gives every process the pixels of the tiles of all: process k has those of shard k.
    virtual void share_pixels(RenderState& state) const = 0;
};

}  // namespace covtrace
