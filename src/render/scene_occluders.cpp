#include "render/scene_occluders.h"

namespace covtrace {

SceneOccluders::SceneOccluders(RenderJob& job) {
    // The slack of latest_end() is for samples that an image needs.
    const auto cancelled = [&job] {
        return job.monitor.cancelled() || job.monitor.elapsed() >= job.tracing_end();
    };
    every_voxel_ = job.options.occlusion == Occlusion::voxels;
    if (asks_grid(job.options.occlusion)) {
        const PhaseTimer timer(job.monitor, job.seconds(Phase::grid));
        grid_.emplace(job.scene.geometry,
                      VoxelGridOptions{.width = job.options.voxels, .cancelled = cancelled});
        job.result.statistics.memory["occluders"] = grid_->memory();
    } else if (job.options.occlusion == Occlusion::query) {
        const PhaseTimer timer(job.monitor, job.seconds(Phase::outlines));
        query_.emplace(job.scene.geometry, cancelled);
        job.result.statistics.memory["occluders"] = query_->memory();
    }
}

}  // namespace covtrace
