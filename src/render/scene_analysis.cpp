#include "render/scene_analysis.h"

#include "render/ranks.h"

namespace covtrace {

SceneAnalysis::SceneAnalysis(RenderJob& job) : job_(job) {
    {
        const PhaseTimer timer(job.monitor, job.seconds(Phase::spectra));
        spectra_.emplace(job.scene, job.options.texture_bandwidth);
    }
    // The slack of latest_end() is for samples that an image needs. A film that is kept has no
    // covariances of an analysis that time cut short: it could not go on to the same image as
    // without an end. Of several processes the first one keeps it for all.
    const bool keeps = bool(job.keeping.keep);
    const Ranks* ranks = job.keeping.ranks;
    const double end = (ranks ? ranks->any(keeps) : keeps) ? kInfinity : job.tracing_end();
    const auto cancelled = [&job, end] {
        return job.monitor.cancelled() || job.monitor.elapsed() >= end;
    };
    if (asks_grid(job.options.occlusion)) {
        const PhaseTimer timer(job.monitor, job.seconds(Phase::grid));
        grid_.emplace(job.scene.geometry,
                      VoxelGridOptions{.width = job.options.voxels, .cancelled = cancelled});
    } else if (job.options.occlusion == Occlusion::query) {
        const PhaseTimer timer(job.monitor, job.seconds(Phase::outlines));
        query_.emplace(job.scene.geometry, cancelled);
    }
    note_memory();
}

PathReplay SceneAnalysis::replay() const {
    return {job_.scene,
            *spectra_,
            {grid_ ? &*grid_ : nullptr, query_ ? &*query_ : nullptr,
             job_.options.occlusion == Occlusion::voxels},
            job_.options.brdf_covariance};
}

void SceneAnalysis::note_memory() const {
    auto& memory = job_.result.statistics.memory;
    memory["spectra"] = spectra_->textures.memory();
    if (grid_) memory["occluders"] = grid_->memory();
    if (query_) memory["occluders"] = query_->memory();
}

}  // namespace covtrace
