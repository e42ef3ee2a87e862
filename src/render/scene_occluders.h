/// The occluders of a scene for the frequency analysis of one render.
#pragma once

#include <optional>

#include "frequency/occlusion.h"
#include "occluders/query.h"
#include "occluders/voxel_grid.h"
#include "render/job.h"

namespace covtrace {

/// Owner of the source that the options choose for what the frequency analysis learns of occluders.
class SceneOccluders {
  public:
    explicit SceneOccluders(RenderJob& job);
    /// The occluders, valid while this object lives.
    Occluders view() const {
        return {grid_ ? &*grid_ : nullptr, query_ ? &*query_ : nullptr, every_voxel_};
    }

  private:
    std::optional<VoxelGrid> grid_;
    std::optional<OccluderQuery> query_;
    bool every_voxel_ = false;
};

}  // namespace covtrace
