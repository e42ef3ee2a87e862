#include "render/job.h"

#include <algorithm>
#include <cmath>

namespace covtrace {

RenderJob::RenderJob(RenderScene& render_scene, const RenderOptions& render_options,
                     Monitor& render_monitor)
    : scene(render_scene),
      options(render_options),
      monitor(render_monitor),
      region(render_region(scene.description.film)),
      display{0, 0, scene.description.film.width, scene.description.film.height},
      context{scene,
              options.seed,
              options.max_depth.value_or(scene.description.max_depth),
              (scene.description.camera.shutter_close - scene.description.camera.shutter_open) *
                  scene.description.film.iso / 100 * scene.description.camera.film_irradiance,
              scene.description.film.max_component_value,
              scene.description.film.white_balance} {
    if (options.spp || (!options.seconds && !options.error))
        target_spp = options.spp.value_or(scene.description.samples_per_pixel);
}

PassProgress RenderJob::reporter(const char* name, double from, double to) {
    const double begin = fraction(from), end = fraction(to);
    return [this, name, from, to, begin, end](double f) {
        monitor.update(name, begin + f * (end - begin), from + f * (to - from));
    };
}

double RenderJob::fraction(double spp) const {
    double f = 0;
    if (target_spp) f = spp / *target_spp;
    if (options.seconds) f = std::max(f, monitor.elapsed() / *options.seconds);
    return std::clamp(f, 0.0, 1.0) * kTracingShare;
}

double RenderJob::plan_round(double taken, double round_end) const {
    double target = round_end;
    if (target_spp) target = std::min(target, *target_spp);
    if (options.seconds && traced_spp_ > 0) {
        const double left = *options.seconds - reserve_ - monitor.elapsed();
        const double affordable =
            taken + std::floor(left / (traced_seconds_ / traced_spp_) * 16) / 16;
        target = std::min(target, affordable);
    }
    return std::max(target, taken);
}

void RenderJob::traced(double spp, double seconds) {
    traced_seconds_ += seconds;
    traced_spp_ += spp;
}

SceneOccluders::SceneOccluders(RenderJob& job) {
    const auto cancelled = [&job] { return job.monitor.cancelled(); };
    if (job.options.occlusion == Occlusion::grid) {
        const PhaseTimer timer(job.monitor, job.phase("grid"));
        grid_.emplace(job.scene.geometry,
                      VoxelGridOptions{.width = job.options.voxels, .cancelled = cancelled});
        job.result.statistics.memory["occluders"] = grid_->memory();
    } else if (job.options.occlusion == Occlusion::query) {
        const PhaseTimer timer(job.monitor, job.phase("outlines"));
        query_.emplace(job.scene.geometry, cancelled);
        job.result.statistics.memory["occluders"] = query_->memory();
    }
}

}  // namespace covtrace
