#include "frequency/replay.h"

#include <algorithm>

#include "frequency/path_walk.h"

namespace covtrace {

namespace {

/// Share of a path's luminance below which a contribution or lobe is not followed: whatever a
/// filter does to it alone changes a pixel by less than counts as a change
/// (docs/internals/prediction.md).
constexpr double kInvisible = 0.02;
/// Share of a path's light that must be followed. The contributions left out may together be as
/// much as one may be that is carried without its occluders; where they are more, every one is
/// followed.
constexpr double kLeastFollowed = 1 - kSmallestShare;

}  // namespace

ReplayedScene::ReplayedScene(const LitScene& lit_scene, const SceneSpectra& scene_spectra,
                             const Occluders& scene_occluders, BrdfCovariance brdf_rule)
    : scene(lit_scene), spectra(scene_spectra), occluders(scene_occluders), rule(brdf_rule) {
    const Bounds3 bounds = lit_scene.geometry.bounds();
    center = bounds.center();
    radius = std::max(bounds.radius(), 1e-6f);
    smallest = 1e-4 * radius;
}

Vec3 ReplayedScene::entry(Vec3 p, Vec3 w) const {
    const Vec3 o = p - center;
    const float b = dot(o, w), c = length_squared(o) - sqr(radius);
    return p + w * std::max(0.0f, -b + safe_sqrt(b * b - c));
}

PathCovariance PathReplay::operator()(const PathRecord& record, LightPart part) const {
    PathWalk visible(context_, record, part, kInvisible);
    const PathCovariance bright = visible.run();
    if (!(bright.weight > 0) || visible.kept() > kLeastFollowed * bright.weight) return bright;
    return PathWalk(context_, record, part, 0).run();
}

}  // namespace covtrace
