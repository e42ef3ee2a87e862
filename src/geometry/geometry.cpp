#include "geometry/geometry.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/hash.h"
#include "geometry/embree_shapes.h"
#include "geometry/leave_surface.h"
#include "geometry/placed_scene.h"

namespace covtrace {

namespace {

/// Most surfaces that a ray passes: one that is caught between coincident surfaces must end.
constexpr int kMostLayers = 1000;

/// A hash in [0, 1) of all bits of a ray's origin, direction and time, and of its sample: origins
/// alone are the same for many samples, where coordinates are rounded coarsely.
float ray_hash(const Ray& ray) {
    uint64_t h = hash_combine(ray.sample, std::bit_cast<uint32_t>(ray.time));
    for (const Vec3 v : {ray.origin, ray.direction})
        for (const float c : {v.x, v.y, v.z}) h = hash_combine(h, std::bit_cast<uint32_t>(c));
    return to_unit_float(static_cast<uint32_t>(h >> 32));
}

void set_ray(RTCRay& out, const Ray& ray, const ShutterClock& clock, unsigned mask) {
    out.org_x = ray.origin.x, out.org_y = ray.origin.y, out.org_z = ray.origin.z;
    out.dir_x = ray.direction.x, out.dir_y = ray.direction.y, out.dir_z = ray.direction.z;
    out.tnear = 0;
    out.tfar = ray.t_max;
    out.time = clock.parameter(ray.time);
    out.mask = mask;
    out.id = 0;
    out.flags = 0;
}

/// Moves `point` from the local space of an instance to the world.
void place(SurfacePoint& point, const Affine& world_from_local, const Affine& local_from_world) {
    const Affine& map = world_from_local;
    point.error *= std::sqrt(std::max(
        {dot(map.row[0], map.row[0]), dot(map.row[1], map.row[1]), dot(map.row[2], map.row[2])}));
    point.position = map.point(point.position);
    point.error += instance_error(map, local_from_world, point.position);
    point.ng = normalize(map.normal(point.ng));
    point.ns = normalize(map.normal(point.ns));
    if (dot(point.ng, point.ns) < 0) point.ns = point.ns * -1.0;
    point.dpdu = map.vector(point.dpdu);
    point.dpdv = map.vector(point.dpdv);
    point.tangent = map.vector(point.tangent);
}

/// Writes `point`, which is in the world, into a hit of a ray with this direction.
void fill_hit(const SurfacePoint& point, Vec3 direction, SurfaceHit& hit) {
    hit.position = point.position.to_float();
    hit.ng = point.ng.to_float();
    hit.ns = point.ns.to_float();
    const float cosine = std::min(1.0f, std::abs(dot(hit.ns, direction)));
    hit.facing = dot(hit.ng, direction) > 0 ? -cosine : cosine;
    hit.dpdu = point.dpdu.to_float();
    hit.dpdv = point.dpdv.to_float();
    hit.tangent = point.tangent.to_float();
    if (!(length_squared(hit.tangent) > 0)) hit.tangent = hit.dpdu;
    hit.uv = point.uv;
    hit.mesh = point.vertices.mesh;
    const double rounding = kHalfUlp * dot(abs(point.ng), abs(point.position));
    hit.position_error = static_cast<float>(point.error + rounding);
}

/// Finds the nearest hit, by `find(ray, hit)`, at which `stops(ray, hit)` says that the ray ends;
/// the ray goes on behind all other hits.
template <typename Find, typename Stops>
bool first_that_stops(Ray ray, SurfaceHit& hit, const Find& find, const Stops& stops) {
    const Vec3 end = end_of(ray);
    float passed = 0;
    for (int layer = 0; layer < kMostLayers; ++layer) {
        if (!find(ray, hit)) return false;
        if (stops(ray, hit)) {
            hit.t += passed;
            return true;
        }
        passed += go_on_behind(hit, end, ray);
        if (!(ray.t_max > 0)) return false;
    }
    return false;
}

}  // namespace

bool lies_in(Vec3 point, const SurfaceHit& hit) {
    const Vec3d ng(hit.ng), origin(point);
    const double rounding = double(hit.position_error) + 4 * kHalfUlp * dot(abs(ng), abs(origin));
    return std::abs(dot(ng, origin - Vec3d(hit.position))) <= rounding;
}

Geometry::Geometry(const SceneDescription& scene, const std::string& isa)
    : impl_(std::make_unique<Impl>(scene, isa)) {}
Geometry::~Geometry() = default;
Geometry::Geometry(Geometry&&) noexcept = default;
Geometry& Geometry::operator=(Geometry&&) noexcept = default;

void Geometry::set_alpha(AlphaLookup lookup) {
    impl_->alpha = std::move(lookup);
}

bool Geometry::intersect(const Ray& ray, SurfaceHit& hit) const {
    return impl_->nearest_opaque(ray, ray_mask(ray.kind), hit);
}

bool Geometry::intersect_seen(const Ray& ray, SurfaceHit& hit) const {
    return first_that_stops(
        ray, hit, [this](const Ray& r, SurfaceHit& h) { return intersect(r, h); },
        [&](const Ray&, const SurfaceHit& h) { return !lies_in(ray.origin, h); });
}

bool Geometry::Impl::nearest_opaque(const Ray& ray, unsigned mask, SurfaceHit& hit) const {
    const auto find = [this, mask](const Ray& r, SurfaceHit& h) { return nearest(r, mask, h); };
    if (!any_alpha) return find(ray, hit);
    return first_that_stops(ray, hit, find, [this](const Ray& r, const SurfaceHit& h) {
        const PlacedShape& shape = placed[h.shape];
        const Vec3 outward = shape.description.reverse_orientation ? -h.ng : h.ng;
        if (shape.is_left_freely && dot(r.direction, outward) > 0) return false;
        const TextureId texture = shape.description.alpha;
        const float opacity = texture >= 0 && alpha
                                  ? alpha(texture, {h.uv, h.position, h.vertices(), h.ng, h.facing})
                                  : 1.0f;
        return opacity >= 1 || (opacity > 0 && ray_hash(r) < opacity);
    });
}

bool Geometry::Impl::nearest(const Ray& ray, unsigned mask, SurfaceHit& hit) const {
    if (!can_follow(ray)) return false;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query;
    set_ray(query.ray, ray, clock, mask);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(top.scene.get(), &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;

    fill({query.ray.tfar,
          query.hit.geomID,
          query.hit.instID[0],
          query.hit.primID,
          {query.hit.u, query.hit.v}},
         ray, hit);
    return true;
}

void Geometry::Impl::fill(const EmbreeHit& found, const Ray& ray, SurfaceHit& hit) const {
    fill_found(found, ray, hit);
    const auto* triangles = std::get_if<TriangleShape>(&local[hit.shape]);
    if (!triangles || !triangles->opposites || !(dot(ray.direction, hit.ng) > 0)) return;
    EmbreeHit front = found;
    std::tie(front.primitive, front.barycentric) =
        triangles->opposites->at(*triangles->mesh, found.primitive, found.barycentric);
    if (front.primitive != found.primitive) fill_found(front, ray, hit);
}

void Geometry::Impl::fill_found(const EmbreeHit& found, const Ray& ray, SurfaceHit& hit) const {
    hit.t = found.t;
    hit.time = ray.time;
    hit.sample = ray.sample;
    hit.primitive = found.primitive;
    hit.barycentric = found.barycentric;
    const Vec3d near = Vec3d(ray.origin) + Vec3d(ray.direction) * double(hit.t);
    if (found.instance == RTC_INVALID_GEOMETRY_ID) {
        hit.instance = 0;
        hit.shape = shape_of(found.geometry, found.instance);
        fill_hit(surface_point(local[hit.shape], hit.primitive, hit.barycentric, near),
                 ray.direction, hit);
        return;
    }
    hit.instance = found.instance + 1;
    const EmbreeInstance& instance = instances[found.instance];
    hit.shape = shape_of(found.geometry, found.instance);
    const Affine map = world_from_local(instance, ray.time);
    const Affine inverse = map.inverse();
    SurfacePoint point =
        surface_point(local[hit.shape], hit.primitive, hit.barycentric, inverse.point(near));
    place(point, map, inverse);
    fill_hit(point, ray.direction, hit);
}

bool Geometry::occluded(const Ray& ray) const {
    return impl_->meets_any(ray, kSolidMask);
}

bool Geometry::blocked(const Ray& ray) const {
    return impl_->meets_any(ray, kBlockingMask);
}

bool Geometry::intersect_behind_panes(const Ray& ray, SurfaceHit& hit) const {
    return impl_->nearest_opaque(ray, kBehindPanesMask, hit);
}

bool Geometry::Impl::meets_any(const Ray& ray, unsigned mask) const {
    if (!can_follow(ray)) return false;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay query;
    set_ray(query, ray, clock, mask);
    rtcOccluded1(top.scene.get(), &context, &query);
    if (query.tfar < 0) return true;
    SurfaceHit hit;
    return any_alpha && mask == kSolidMask && nearest_opaque(ray, kAlphaMask, hit);
}

Vec3 Geometry::offset_origin(const SurfaceHit& hit, Vec3 direction) {
    return off_surface(Vec3d(hit.position), hit.ng, double(hit.position_error), direction);
}

const std::vector<PlacedShape>& Geometry::shapes() const {
    return impl_->placed;
}

WorldTriangle Geometry::world_triangle(uint32_t shape, uint32_t triangle, float time) const {
    const LocalShape& local = impl_->local[shape];
    WorldTriangle w;
    if (const auto* mesh = std::get_if<TriangleShape>(&local)) {
        const auto& index = mesh->mesh->triangles[triangle];
        w = {mesh->positions[index[0]], mesh->positions[index[1]], mesh->positions[index[2]]};
    } else {
        const auto& patches = std::get<PatchShape>(local);
        const auto& i = patches.mesh->patches[triangle / 2];
        const auto& p = patches.positions;
        w = triangle % 2 == 0 ? WorldTriangle{p[i[0]], p[i[1]], p[i[2]]}
                              : WorldTriangle{p[i[3]], p[i[2]], p[i[1]]};
    }
    if (!moves(shape)) return w;
    const float clamped = std::clamp(time, impl_->clock.open(), impl_->clock.close());
    const Transform map = impl_->placed[shape].description.object_to_world.at(clamped);
    return {map.point(w.p0), map.point(w.p1), map.point(w.p2)};
}

bool Geometry::moves(uint32_t shape) const {
    return Motion{nullptr, &impl_->placed[shape].description.object_to_world}.moves(
        impl_->clock.open(), impl_->clock.close());
}

Affine Geometry::world_from_object(uint32_t shape, float time) const {
    const int instance = impl_->instance_of_shape[shape];
    if (instance >= 0)
        return impl_->world_from_local(impl_->instances[static_cast<size_t>(instance)], time);
    return Affine::from_matrix(impl_->placed[shape].description.object_to_world.matrix_at(time));
}

const std::string& Geometry::isa() const {
    return impl_->device.isa();
}
bool Geometry::has_panes() const {
    return impl_->any_pane;
}

bool Geometry::has_interfaces() const {
    return impl_->any_interface;
}
bool Geometry::kinds_differ() const {
    return impl_->kinds_differ;
}
bool Geometry::shadows_differ() const {
    return impl_->shadows_differ;
}

Bounds3 Geometry::bounds() const {
    return impl_->bounds;
}

size_t Geometry::embree_memory() const {
    return impl_->device.most_bytes();
}

size_t Geometry::memory() const {
    size_t bytes = impl_->placed.capacity() * sizeof(PlacedShape) +
                   impl_->local.capacity() * sizeof(LocalShape) +
                   impl_->instances.capacity() * sizeof(EmbreeInstance) +
                   impl_->instance_of_shape.capacity() * sizeof(int);
    for (const LocalShape& shape : impl_->local) {
        if (const auto* mesh = std::get_if<TriangleShape>(&shape))
            bytes += mesh->positions.capacity() * sizeof(Vec3);
        if (const auto* patches = std::get_if<PatchShape>(&shape))
            bytes += patches->positions.capacity() * sizeof(Vec3);
    }
    return bytes;
}

}  // namespace covtrace
