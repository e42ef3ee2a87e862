#include "frequency/occlusion.h"

#include <algorithm>
#include <cmath>

#include "occluders/voxel_walk.h"

namespace covtrace {

namespace cov = covariance;

namespace {

/// Widest feature that a filter can lose, pixels. The widest filter has a standard deviation of 15
/// pixels and passes, at c = 2, no signal narrower than twice that.
constexpr double kWidestFeature = 30;
/// Factor of an edge's distance beside its blur when it is looked for, so that edges farther than 8
/// pixels are left out: there a filter could by itself be 0.25 * 8 pixels wide, and those of its
/// neighbours nearer to the edge limit it to half a pixel + 0.1 * 8.
constexpr double kDistance = kWidestFeature / 8;
/// Angular window from which on lobes are sharp for this purpose, 1/rad^2.
constexpr double kSharpWindow = 1e6;
constexpr double kDiffuseWindow = 1 / (cov::pi<double> * cov::pi<double>);

double feature_slope(const SensorGeometry& camera) {
    return camera.orthographic ? 0 : kWidestFeature / camera.pixels_per_x;
}

double sharpest_window(const LobeShares& lobes) {
    double window = kDiffuseWindow;
    for (int i = 0; i < lobes.count; ++i) {
        const LobeShare& lobe = lobes.lobes[size_t(i)];
        switch (lobe.kind) {
            case LobeKind::diffuse_reflection:
            case LobeKind::diffuse_transmission:
            case LobeKind::sheen_reflection:
                break;
            case LobeKind::specular_reflection:
            case LobeKind::specular_transmission:
                return kSharpWindow;
            case LobeKind::hair_reflection:
            case LobeKind::hair_transmission: {
                const double narrower = std::min(lobe.alpha_x, lobe.alpha_y);
                window = std::max(window, 1 / (cov::four_pi_sq<double> * narrower * narrower));
                break;
            }
            case LobeKind::glossy_reflection:
            case LobeKind::glossy_transmission: {
                // Outgoing slopes are twice as wide as the half vector's.
                const auto micro = cov::micro_ggx<double>(lobe.alpha_x, lobe.alpha_y);
                window = std::max(window, 0.25 * std::max(micro.xx, micro.yy));
                break;
            }
        }
    }
    return std::min(window, kSharpWindow);
}

LightField past_voxels(const VoxelGrid& grid, LightField field,
                       const OccluderQuery::Segment& segment, double length,
                       EdgeMeasure::Range range) {
    double at = 0;
    const float voxel = grid.voxel_size();
    const auto total = static_cast<float>(length);
    VoxelMarch march(grid, segment.begin, segment.end, total - range.hi, total - range.lo);
    OccluderEvent e;
    while (march.next(float(std::min(cov::footprint_radius(field.sigma), 3.0 * voxel)), e)) {
        field = cov::travel(field, e.s - at);
        at = e.s;
        // Touching means so near that the direction to the centroid is chance: the surface's
        // normals tell where its edge is.
        const bool touches = covtrace::length(e.offset) < 0.5f * voxel;
        const NormalTensor& n = e.normals;
        field = touches ? cov::occlude(field, cov::Sym3<double>{n.xx, n.xy, n.xz, n.yy, n.yz, n.zz},
                                       0.5 * voxel, e.velocity)
                        : cov::occlude(field, e.offset, 0.5 * voxel, e.velocity);
    }
    return cov::travel(field, length - at);
}

/// Voxels along the longest side of the grid of Belcour 2012.
constexpr double kThesisWidth = 200;

/// Carries light past every occupied voxel on its way, as in Belcour 2012: an occupied voxel is a
/// thick occluder, which is several planar ones, one behind the other, whose edges lie across the
/// voxel's normals and wherever the light passes. A slice is as thick as a voxel of a grid of that
/// width, and its edge half of that away, whatever the width of the grid at hand: a coarser grid is
/// thicker around the same surfaces, and occludes more.
LightField past_every_voxel(const VoxelGrid& grid, LightField field,
                            const OccluderQuery::Segment& segment, double length) {
    const double slice = double(grid.longest_side()) / kThesisWidth;
    double at = 0;
    VoxelWalk walk(grid, segment.begin, segment.end);
    for (VoxelWalk::Crossing c; walk.next(c);) {
        if (!(c.length > 0)) continue;
        field = cov::travel(field, c.s - at);
        at = c.s;
        const NormalTensor& n = c.voxel->normals;
        // The voxel counts as c.length / slice slices.
        field = cov::occlude(field, cov::Sym3<double>{n.xx, n.xy, n.xz, n.yy, n.yz, n.zz},
                             0.5 * slice * std::sqrt(slice / c.length), c.voxel->velocity);
    }
    return cov::travel(field, length - at);
}

/// Whether an own outline makes features narrow enough, at the end of the segment, to matter.
bool matters(const OwnOutline& own, const EdgeMeasure& measure, const cov::Vec3<double>& travel,
             double length) {
    const auto z = static_cast<float>(length - cov::dot(own.contour.offset, travel));
    const auto r = static_cast<float>(own.contour.distance);
    return measure.width_squared(z, r * r) < measure.widest * measure.widest;
}

LightField past_outlines(const OutlineEvents& found, const LightField& light, double length,
                         double smallest) {
    LightField field = light;
    double at = 0;
    for (size_t i = 0; i < found.count; ++i) {
        const OutlineEvent& e = found.events[i];
        field = cov::travel(field, length - e.z - at);
        at = length - e.z;
        field =
            cov::occlude(field, e.direction * std::max(e.distance, 1e-30f), smallest, e.velocity);
    }
    return cov::travel(field, length - at);
}

}  // namespace

double sharpest_window(const PathVertex& vertex) {
    return std::max({vertex.direct > 0 ? sharpest_window(vertex.direct_event.lobes) : 0,
                     vertex.mirrored > 0 ? sharpest_window(vertex.mirrored_event.lobes) : 0,
                     vertex.scatters ? sharpest_window(vertex.next_event.lobes) : 0});
}
Visibility first_visibility(const SensorGeometry& camera, double distance, double window) {
    return {camera.orthographic ? kWidestFeature / camera.pixels_per_x
                                : feature_slope(camera) * distance,
            window};
}

Visibility next_visibility(const SensorGeometry& camera, const Visibility& nearer, double distance,
                           double window) {
    const double sharp = nearer.extent + feature_slope(camera) * distance;
    const double blur = distance * distance / (cov::four_pi_sq<double> * nearer.window);
    const double extent2 = sharp * sharp - blur;
    if (!(nearer.extent > 0) || !(extent2 > 0)) return {};
    return {std::sqrt(extent2), window};
}

EdgeMeasure measure_at_surface(const cov::SymmetricMatrix5<double>& sigma, double length,
                               const Visibility& end) {
    // The light arrives as if nothing stood beside its way, then goes through the lobe; both axes
    // are added up in one. With M over (x, u) an edge q w w^T, w = (1, -z), makes the Schur
    // complement (det M + q h) / (Muu + q z^2), h = w^T adj(M) w.
    const auto arriving = cov::travel(sigma, length);
    const double xx = arriving(0, 0) + arriving(1, 1), xu = arriving(0, 2) + arriving(1, 3),
                 uu = arriving(2, 2) + arriving(3, 3) + 2 * end.window;
    EdgeMeasure m;
    const double scale = 1 / uu;
    m.a1 = static_cast<float>(std::sqrt(scale) / (2 * cov::pi<double>));
    m.b = static_cast<float>(kDistance * kDistance);
    m.h0 = 1;
    m.h1 = static_cast<float>(2 * xu * scale);
    m.h2 = static_cast<float>(xx * scale);
    m.widest = static_cast<float>(end.extent);
    return m;
}

EdgeMeasure measure_at_camera(const SensorGeometry& camera) {
    // Widths are slopes, beside a circle of confusion; for parallel rays they are lengths.
    EdgeMeasure m;
    m.a0 = 0.5f * camera.lens_radius;
    m.a1 = -m.a0 / camera.focal_distance;
    m.b = static_cast<float>(kDistance * kDistance);
    m.h0 = camera.orthographic ? 1.0f : 0.0f;
    m.h2 = camera.orthographic ? 0.0f : 1.0f;
    m.widest = static_cast<float>(kWidestFeature) / camera.pixels_per_x;
    return m;
}

LightField travel_past(const Occluders& occluders, const LightField& field,
                       const OccluderQuery::Segment& segment, const EdgeMeasure& measure,
                       const OwnOutline* own, double smallest) {
    const double length = distance(segment.begin, segment.end);
    if (occluders.query) {
        const OutlineEvents found =
            (*occluders.query)(segment, measure, static_cast<float>(smallest));
        if (own && matters(*own, measure, field.frame.z, length))
            return past_outlines(found,
                                 cov::end_at_contour(field, own->contour, smallest, own->motion),
                                 length, smallest);
        if (found.count > 0) return past_outlines(found, field, length, smallest);
    } else if (occluders.grid && occluders.every_voxel) {
        return past_every_voxel(*occluders.grid, field, segment, length);
    } else if (occluders.grid) {
        const EdgeMeasure::Range range = measure.reach(static_cast<float>(length));
        if (range.lo <= range.hi)
            return past_voxels(*occluders.grid, field, segment, length, range);
    }
    return cov::travel(field, length);
}

}  // namespace covtrace
