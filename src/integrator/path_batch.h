/// Paths that are traced side by side.
#pragma once

#include <functional>
#include <memory>

#include "integrator/path.h"

namespace covtrace {

/// A number of paths that take their steps together, so that their rays are traced together: in
/// less time than path by path, and each path to the same bits, whichever others are with it.
class PathBatch {
  public:
    /// Most paths in a batch.
    static constexpr size_t kMost = 128;

    PathBatch(const RenderScene& scene, int max_depth);
    ~PathBatch();
    PathBatch(const PathBatch&) = delete;
    PathBatch& operator=(const PathBatch&) = delete;

    /// Adds a path, which is trace_path's.
    void add(const Ray& ray, const Sampler& sampler);
    size_t size() const;
    bool full() const { return size() == kMost; }
    void clear();

    /// Traces all paths; returns false where `stop`, which is asked before every step, ended them
    /// before their time.
    bool trace(const std::function<bool()>& stop);
    /// The result of path number `i`, once all have been traced.
    const PathResult& result(size_t i) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace covtrace
