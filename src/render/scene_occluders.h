/// The occluders of a scene for the frequency analysis of one render.
#pragma once

#include <optional>

#include "frequency/occlusion.h"
#include "occluders/query.h"
#include "occluders/voxel_grid.h"
#include "render/job.h"

namespace covtrace {

/// What the frequency analysis learns of occluders from, as the options ask.
class SceneOccluders {
  public:
    explicit SceneOccluders(RenderJob& job);
    /// Valid while this lives.
    Occluders view() const {
        return {grid_ ? &*grid_ : nullptr, query_ ? &*query_ : nullptr, every_voxel_};
    }

  private:
    std::optional<VoxelGrid> grid_;
    std::optional<OccluderQuery> query_;
    bool every_voxel_ = false;
};

}  // namespace covtrace
