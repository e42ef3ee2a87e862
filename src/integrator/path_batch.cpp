#include "integrator/path_batch.h"

#include <array>
#include <span>
#include <vector>

#include "integrator/path_tracer.h"

namespace covtrace {

namespace {

/// The path loop, with room for `most` paths; returns false where `stop` ended it.
template <size_t most, typename Stop>
bool trace_paths(const Geometry& geometry, std::span<PathTracer> paths, const Stop& stop) {
    std::array<PathTracer*, most> alive, lit;
    std::array<HitQuery, most> hits;
    std::array<OcclusionQuery, most> shadows;
    size_t count = 0;
    for (PathTracer& path : paths) alive[count++] = &path;
    for (bool from_camera = true; count > 0; from_camera = false) {
        if (stop()) return false;
        // Find the nearest surface of each path
        const std::span<HitQuery> queries(hits.data(), count);
        for (size_t i = 0; i < count; ++i) queries[i] = {&alive[i]->next_ray(), &alive[i]->hit()};
        if (from_camera)
            geometry.intersect_seen(queries);
        else
            geometry.intersect(queries);
        for (size_t i = 0; i < count; ++i) alive[i]->prefetch(queries[i].found);
        // Meet it: paths that end leave the others
        size_t left = 0, shadow_count = 0;
        for (size_t i = 0; i < count; ++i) {
            PathTracer& path = *alive[i];
            const bool goes_on = path.meet(queries[i].found);
            if (const Ray* ray = path.ray_to_light()) {
                lit[shadow_count] = &path;
                shadows[shadow_count++] = {ray};
            }
            if (goes_on) alive[left++] = &path;
        }
        count = left;
        // Look whether the sampled lights are to be seen
        const std::span<OcclusionQuery> to_light(shadows.data(), shadow_count);
        geometry.occluded(to_light);
        for (size_t i = 0; i < shadow_count; ++i) lit[i]->add_sampled_light(to_light[i].occluded);
        // Look whether nothing but panes hides the others
        size_t hidden_count = 0;
        for (size_t i = 0; i < shadow_count; ++i) {
            const Ray* ray = lit[i]->ray_to_light();
            if (!ray) continue;
            lit[hidden_count] = lit[i];
            shadows[hidden_count++] = {ray};
        }
        const std::span<OcclusionQuery> to_hidden(shadows.data(), hidden_count);
        geometry.blocked(to_hidden);
        for (size_t i = 0; i < hidden_count; ++i)
            lit[i]->add_light_through_panes(to_hidden[i].occluded);
    }
    return true;
}

}  // namespace

struct PathBatch::Impl {
    const RenderScene& scene;
    const int max_depth;
    std::vector<PathTracer> paths;
};

PathBatch::PathBatch(const RenderScene& scene, int max_depth)
    : impl_(new Impl{scene, max_depth, {}}) {
    impl_->paths.reserve(kMost);
}
PathBatch::~PathBatch() = default;

void PathBatch::add(const Ray& ray, const Sampler& sampler) {
    const RenderScene& scene = impl_->scene;
    impl_->paths.emplace_back(scene, scene.guide, &scene.sky_guide, &scene.lamp_guide,
                              &scene.path_guide, ray, sampler, impl_->max_depth, nullptr);
}

size_t PathBatch::size() const {
    return impl_->paths.size();
}

void PathBatch::clear() {
    impl_->paths.clear();
}

bool PathBatch::trace(const std::function<bool()>& stop) {
    return trace_paths<kMost>(impl_->scene.geometry, impl_->paths, stop);
}

const PathResult& PathBatch::result(size_t i) const {
    return impl_->paths[i].result();
}

PathResult trace_path(const LitScene& scene, const CausticGuide& guide, Ray ray,
                      const Sampler& sampler, int max_depth, PathRecord* record,
                      const SkyGuide* sky_guide, const LampGuide* lamp_guide,
                      const PathGuide* path_guide) {
    PathTracer path(scene, guide, sky_guide, lamp_guide, path_guide, ray, sampler, max_depth,
                    record);
    trace_paths<1>(scene.geometry, {&path, 1}, [] { return false; });
    return path.result();
}

PathResult trace_path_from(const LitScene& scene, const LitPlace& place, float pdf, Ray ray,
                           const Sampler& sampler, int max_depth) {
    const CausticGuide none;
    PathTracer path(scene, none, nullptr, nullptr, nullptr, ray, sampler, max_depth, nullptr);
    path.leave_from(place, pdf);
    trace_paths<1>(scene.geometry, {&path, 1}, [] { return false; });
    return path.result();
}

}  // namespace covtrace
