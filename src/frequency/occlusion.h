/// Travel past occluders beside the way: the search for them, how near an edge must be to matter,
/// and the operator applied at each.
#pragma once

#include "camera/camera.h"
#include "covariance/covariance.hpp"
#include "frequency/light_source.h"
#include "integrator/path_record.h"
#include "occluders/query.h"
#include "occluders/voxel_grid.h"

namespace covtrace {

/// Sources that know the occluders: at most one of grid and query. With neither, light travels as
/// if nothing stood beside its way.
struct Occluders {
    const VoxelGrid* grid = nullptr;
    const OccluderQuery* query = nullptr;
    /// Whether every occupied voxel of the grid on the way occludes, wherever its surface lies;
    /// otherwise the nearest voxels beside the way do, at their distance.
    bool every_voxel = false;
    explicit operator bool() const { return grid || query; }
};

/// The camera's view of features in the light that arrives at a vertex.
struct Visibility {
    /// Standard deviation of the widest feature at the vertex that may still narrow a filter, scene
    /// units; 0 if none may.
    double extent;
    /// Angular variance, 1/rad^2 per axis, of the sharpest lobe by which the vertex sends light on.
    double window;
};

/// The angular window of the sharpest lobe of a recorded vertex; diffuse lobes count with that of
/// the cosine.
double sharpest_window(const PathVertex& vertex);
/// The view of the path's first vertex, `distance` from the camera; `window` is the vertex' own.
Visibility first_visibility(const SensorGeometry& camera, double distance, double window);
/// The view of the next vertex (away from the camera), `distance` from a vertex with the view
/// `nearer`: a rough surface blurs features that are far from it.
Visibility next_visibility(const SensorGeometry& camera, const Visibility& nearer, double distance,
                           double window);

/// The measure of edges beside light that leaves with `sigma` and travels `length` to a surface.
EdgeMeasure measure_at_surface(const covariance::SymmetricMatrix5<double>& sigma, double length,
                               const Visibility& end);
EdgeMeasure measure_at_camera(const SensorGeometry& camera);

/// The outline of the surface itself that light has just left. Voxels contain it; a query does not,
/// as it lies at or behind the point where the segment starts.
struct OwnOutline {
    covariance::Contour<double> contour;
    covariance::Motion<double> motion;  ///< motion of the point where the segment starts
};

/// Carries light along a segment, past the occluders that matter. `own` is null where there is no
/// own outline; `smallest` is the extent that stands for a point, scene units.
LightField travel_past(const Occluders& occluders, const LightField& field,
                       const OccluderQuery::Segment& segment, const EdgeMeasure& measure,
                       const OwnOutline* own, double smallest);

}  // namespace covtrace
