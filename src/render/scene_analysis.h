/// A scene as the frequency analysis of one render sees it: spectra and occluders.
#pragma once

#include <optional>

#include "frequency/replay.h"
#include "frequency/scene_spectra.h"
#include "occluders/query.h"
#include "occluders/voxel_grid.h"
#include "render/job.h"

namespace covtrace {

/// The scene's spectra and occluders, as the options ask.
class SceneAnalysis {
  public:
    /// `job` must outlive this.
    explicit SceneAnalysis(RenderJob& job);
    /// Valid while this lives.
    PathReplay replay() const;
    /// Puts the bytes that this holds by now into the job's statistics. Not while paths are
    /// replayed.
    void note_memory() const;

  private:
    RenderJob& job_;
    std::optional<SceneSpectra> spectra_;
    std::optional<VoxelGrid> grid_;
    std::optional<OccluderQuery> query_;
};

}  // namespace covtrace
