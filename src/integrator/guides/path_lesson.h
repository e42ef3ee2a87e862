/// Lessons for a guide: the surfaces that paths from the camera visited, and where they went on.
#pragma once

#include <cstdint>
#include <vector>

#include "integrator/guides/place_tree.h"

namespace covtrace {

struct LitScene;
class CausticGuide;
class LampGuide;
class SkyGuide;
class PathGuide;

/// A way from a visited surface to the next one, by a lobe that is not specular.
struct GuideBounce {
    uint32_t from = 0;       ///< number of the visit that it begins at
    int32_t to = -1;         ///< number of the visit that it ends at; -1: none
    bool is_guided = false;  ///< whether a guide could lead it
    Vec3 direction;          ///< unit, world
    /// Luminance of the light that it found on its way, as far as light sampling leaves it to
    /// paths, and what mirrors, panes and media let through of the light at its end.
    float found = 0, passed = 1;
    /// Luminance of BSDF times cosine, density of the direction, survival of roulette included, and
    /// that of the BSDF alone.
    float value = 0, path_pdf = 0, bsdf_pdf = 0;
    float reflected = 0;  ///< luminance of the light that is seen at the visit, per light found
    /// Luminance of what the path carries to the surface, over the brightness around its pixel.
    float carried = 0;
    uint32_t path = 0;  ///< number of the path
};

/// Paths that were traced to learn from.
struct PathLesson {
    std::vector<PlaceTree::Place> places;  ///< visited surfaces that are not specular
    /// Luminance that leaves each of them: of the light sampled there, and of all light found.
    std::vector<float> direct, light;
    std::vector<GuideBounce> bounces;
    double second_moment = 0;  ///< of the paths' light, over the brightness around its pixel
    int64_t paths = 0;
};

/// Traces `count` camera paths, the first of them number `first`, led by guides. The result is
/// deterministic.
PathLesson trace_lesson(const LitScene& scene, const CausticGuide& caustics, const SkyGuide& sky,
                        const LampGuide& lamps, const PathGuide& guide, int64_t first,
                        int64_t count);
/// Adds a lesson to another.
void append(PathLesson& lesson, const PathLesson& more);

}  // namespace covtrace
