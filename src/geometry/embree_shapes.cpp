#include "geometry/embree_shapes.h"

#include <algorithm>
#include <array>

#include "geometry/quadric.h"

namespace covtrace {

namespace {

// Callbacks always get N = 1, because rays meet these shapes one by one.

Vec3d origin_of(const RTCRay& ray) {
    return {ray.org_x, ray.org_y, ray.org_z};
}
Vec3d direction_of(const RTCRay& ray) {
    return {ray.dir_x, ray.dir_y, ray.dir_z};
}

void set_bounds(const Bounds3& box, RTCBounds& out) {
    out.lower_x = box.lo.x, out.lower_y = box.lo.y, out.lower_z = box.lo.z;
    out.upper_x = box.hi.x, out.upper_y = box.hi.y, out.upper_z = box.hi.z;
}

void quadric_bounds_callback(const RTCBoundsFunctionArguments* args) {
    set_bounds(quadric_bounds(*static_cast<const Quadric*>(args->geometryUserPtr)),
               *args->bounds_o);
}

bool hit_primitive(const Quadric& quadric, unsigned, const RTCRay& ray, PatchHit& hit) {
    return intersect_quadric(quadric, origin_of(ray), direction_of(ray), ray.tnear, ray.tfar,
                             hit.t);
}

void patch_bounds_callback(const RTCBoundsFunctionArguments* args) {
    const auto& shape = *static_cast<const PatchShape*>(args->geometryUserPtr);
    Bounds3 box;
    for (uint32_t corner : shape.mesh->patches[args->primID]) box.extend(shape.positions[corner]);
    set_bounds(box, *args->bounds_o);
}

bool hit_primitive(const PatchShape& shape, unsigned primitive, const RTCRay& ray, PatchHit& hit) {
    return intersect_patch(shape.patch(primitive), origin_of(ray), direction_of(ray), ray.tnear,
                           ray.tfar, hit);
}

template <class Shape>
void intersect_callback(const RTCIntersectFunctionNArguments* args) {
    if (!args->valid[0]) return;
    auto& ray_hit = *reinterpret_cast<RTCRayHit*>(args->rayhit);
    PatchHit hit;
    if (!hit_primitive(*static_cast<const Shape*>(args->geometryUserPtr), args->primID, ray_hit.ray,
                       hit))
        return;
    ray_hit.ray.tfar = static_cast<float>(hit.t);
    ray_hit.hit.u = static_cast<float>(hit.u);
    ray_hit.hit.v = static_cast<float>(hit.v);
    ray_hit.hit.geomID = args->geomID;
    ray_hit.hit.primID = args->primID;
    ray_hit.hit.instID[0] = args->context->instID[0];
}

template <class Shape>
void occluded_callback(const RTCOccludedFunctionNArguments* args) {
    if (!args->valid[0]) return;
    auto& ray = *reinterpret_cast<RTCRay*>(args->ray);
    PatchHit hit;
    if (hit_primitive(*static_cast<const Shape*>(args->geometryUserPtr), args->primID, ray, hit))
        ray.tfar = -kInfinity;
}

template <class Shape>
void set_user(RTCGeometry geometry, const Shape& shape, size_t count, RTCBoundsFunction bounds) {
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(count));
    rtcSetGeometryUserData(geometry, const_cast<Shape*>(&shape));
    rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, &intersect_callback<Shape>);
    rtcSetGeometryOccludedFunction(geometry, &occluded_callback<Shape>);
}

void set_positions(RTCGeometry geometry, const std::vector<Vec3>& positions) {
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               positions.data(), 0, sizeof(Vec3), positions.size() - 1);
}

GeometryHandle build(RTCDevice device, const TriangleShape& shape) {
    const auto& triangles = shape.mesh->triangles;
    if (triangles.empty()) return {};
    GeometryHandle geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
    set_positions(geometry.get(), shape.positions);
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               triangles.data(), 0, sizeof(triangles[0]), triangles.size());
    return geometry;
}

GeometryHandle build(RTCDevice device, const PatchShape& shape) {
    const auto& patches = shape.mesh->patches;
    if (patches.empty()) return {};
    if (!shape.parallelograms) {
        GeometryHandle geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER));
        set_user(geometry.get(), shape, patches.size(), &patch_bounds_callback);
        return geometry;
    }
    // The corners are reordered, as Embree's quads go round; their (u, v) is the bilinear one on
    // parallelograms.
    GeometryHandle geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD));
    set_positions(geometry.get(), shape.positions);
    auto* corners = static_cast<std::array<uint32_t, 4>*>(
        rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4,
                                sizeof(std::array<uint32_t, 4>), patches.size()));
    if (corners)
        std::transform(patches.begin(), patches.end(), corners,
                       [](const std::array<uint32_t, 4>& p) {
                           return std::array<uint32_t, 4>{p[0], p[1], p[3], p[2]};
                       });
    return geometry;
}

GeometryHandle build(RTCDevice device, const Quadric& shape) {
    GeometryHandle geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER));
    set_user(geometry.get(), shape, 1, &quadric_bounds_callback);
    return geometry;
}

}  // namespace

GeometryHandle new_shape_geometry(const EmbreeDevice& device, const LocalShape& shape,
                                  unsigned mask) {
    GeometryHandle geometry =
        std::visit([&](const auto& s) { return build(device.get(), s); }, shape);
    device.check();
    if (!geometry) return geometry;
    rtcSetGeometryMask(geometry.get(), mask);
    rtcCommitGeometry(geometry.get());
    device.check();
    return geometry;
}

bool is_intersected_by_embree(const LocalShape& shape) {
    const auto* patches = std::get_if<PatchShape>(&shape);
    return std::holds_alternative<TriangleShape>(shape) || (patches && patches->parallelograms);
}

}  // namespace covtrace
