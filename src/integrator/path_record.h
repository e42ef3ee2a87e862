/// The record of a path, made on demand: the events that the frequency analysis replays. Plain data
/// with a fixed capacity; the integrator writes it and knows nothing of covariances.
#pragma once

#include <array>

#include "bsdf/bsdf.h"
#include "geometry/hit.h"
#include "light/lights.h"

namespace covtrace {

/// Scattering at a vertex for one pair of directions: the lobes that take part and their shares of
/// the scattered light; none in a medium.
struct ScatterEvent {
    Vec3 wi;  ///< unit, world, away from the surface, towards the place where the light comes from
    LobeShares lobes;
};

/// A place where the path scatters or ends: on a surface, or inside a medium, where of `hit` only
/// position and time mean anything and the events have no lobes.
struct PathVertex {
    SurfaceHit hit;
    MediumId medium = -1;  ///< medium that scatters; -1: on a surface
    Vec3 wo;               ///< unit, world, towards the previous vertex or the camera
    Frame shading;         ///< frame of the BSDF: anisotropic roughness is along its x and y
    /// Whether the frame is turned to let mirrored light leave the surface: reflecting_normal.h.
    bool is_turned = false;
    MaterialId material = -1;

    /// Luminance that reaches the sensor from this vertex' own emission, after multiple importance
    /// sampling.
    float emitted = 0;
    /// Whether all lobes between the camera and this vertex are specular.
    bool seen_sharply = false;
    /// Luminance that reaches the sensor from the media between this vertex and the previous one
    /// (or the camera).
    float glow = 0;

    /// Whether the vertex is seen by specular lobes alone that were all more likely than not: light
    /// found here shows the emitter itself, almost without noise, in the full contrast of its
    /// border.
    bool in_view = false;

    /// Luminance that reaches the sensor by the light sampled here; 0 where there is none. Light
    /// that comes through panes counts as if it came straight.
    float direct = 0;
    LightSample light;          ///< the light sampled here, where `direct` is above 0
    ScatterEvent direct_event;  ///< scattering of the sampled light

    /// Luminance that reaches the sensor by the light that is sampled here by a flat mirror; 0
    /// where there is none. See PathRecord::mirrors.
    float mirrored = 0;
    ScatterEvent mirrored_event;  ///< scattering of that light

    /// Whether the path goes on from here; false at its last vertex.
    bool scatters = false;
    ScatterEvent next_event;  ///< scattering of the light from further along the path

    /// Luminance of the path's throughput as it arrives here and as it goes on, after roulette; 0
    /// where the path ends.
    float carried = 0, carried_on = 0;
    bool is_specular = false;  ///< whether the surface has specular lobes alone
    /// Matter for guides that learn: the normal on the lit side of a surface with a diffuse lobe
    /// that lets no light through (0 elsewhere), the luminance of BSDF times cosine of the next
    /// direction, and that direction's density by the BSDF alone; 0 for specular lobes.
    Vec3 guided_normal;
    float next_value = 0, next_bsdf_pdf = 0;
};

struct PathRecord {
    /// Most vertices in a record. Light from beyond them is left out of the record, not out of the
    /// radiance.
    static constexpr int kCapacity = 24;
    std::array<PathVertex, kCapacity> vertices;
    /// For each vertex with `mirrored` light the place on the mirror, as a vertex where that light
    /// is sampled.
    std::array<PathVertex, kCapacity> mirrors;
    int count = 0;
    Ray camera_ray;
    float escaped = 0;            ///< luminance from the infinite lights where the path left
    Vec3 escape_direction;        ///< direction in which the path left the scene, unit
    float escape_glow = 0;        ///< luminance from the media behind the last vertex
    bool escape_in_view = false;  ///< as PathVertex::in_view; means something where `escaped` > 0
    float last_way = kInfinity;   ///< length of the way behind the last vertex, up to a holdout

    void clear() {
        count = 0;
        escaped = escape_glow = 0;
        last_way = kInfinity;
    }
};

}  // namespace covtrace
