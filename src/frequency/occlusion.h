/// Travel past what stands beside the way: who is asked, how near an edge must be to matter, and
/// the operator applied at each.
#pragma once

#include "covariance/covariance.hpp"
#include "frequency/light_source.h"
#include "integrator/camera.h"
#include "integrator/path_record.h"
#include "occluders/query.h"
#include "occluders/voxel_grid.h"

namespace covtrace {

/// Who knows the occluders: at most one of the two; neither: light travels as if nothing stood
/// beside its way.
struct Occluders {
    const VoxelGrid* grid = nullptr;
    const OccluderQuery* query = nullptr;
    /// With a grid: every occupied voxel on the way occludes, wherever its surface lies, in place
    /// of the nearest ones beside the way at their distance.
    bool every_voxel = false;
    explicit operator bool() const { return grid || query; }
};

/// How features of the light that arrives at a vertex are seen by the camera.
struct Visibility {
    /// Standard deviation of the widest feature at the vertex that may still narrow a filter, scene
    /// units; 0: none may.
    double extent;
    /// Angular variance, 1/rad^2 per axis, of the sharpest lobe by which the vertex sends light on.
    double window;
};

/// The angular window of the sharpest lobe of a recorded vertex: that of the cosine for diffuse
/// ones.
double sharpest_window(const PathVertex& vertex);
/// What the camera can see at the path's first vertex, `distance` from it; `window`: the vertex'.
Visibility first_visibility(const SensorGeometry& camera, double distance, double window);
/// What it can see at the next vertex (away from the camera), `distance` from one where it sees
/// `nearer`: a rough surface blurs what is far from it.
Visibility next_visibility(const SensorGeometry& camera, const Visibility& nearer, double distance,
                           double window);

/// The measure of edges beside light that leaves with `sigma` and travels `length` to a surface.
EdgeMeasure measure_at_surface(const covariance::SymmetricMatrix5<double>& sigma, double length,
                               const Visibility& end);
EdgeMeasure measure_at_camera(const SensorGeometry& camera);

/// The outline of the surface itself that light has just left. Voxels hold it, outlines that are
/// asked for do not: it lies at or behind the point where the segment starts.
struct OwnOutline {
    covariance::Contour<double> contour;
    covariance::Motion<double> motion;  ///< of the point where the segment starts
};

/// Carries light along a segment, past the occluders that matter. `own`: null where there is none;
/// `smallest`: the extent that stands for a point, scene units.
LightField travel_past(const Occluders& occluders, const LightField& field,
                       const OccluderQuery::Segment& segment, const EdgeMeasure& measure,
                       const OwnOutline* own, double smallest);

}  // namespace covtrace
