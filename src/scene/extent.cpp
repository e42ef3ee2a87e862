#include "scene/extent.h"

#include <array>
#include <map>

namespace covtrace {

namespace {

std::array<Vec3, 8> corners(const Bounds3& b) {
    std::array<Vec3, 8> points;
    for (size_t i = 0; i < points.size(); ++i)
        points[i] = {i & 1 ? b.hi.x : b.lo.x, i & 2 ? b.hi.y : b.lo.y, i & 4 ? b.hi.z : b.lo.z};
    return points;
}

/// The vertices of a mesh; null for what is none.
const std::vector<Vec3>* vertices(const ShapeDescription& shape) {
    if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&shape.geometry))
        return &(*mesh)->positions;
    if (const auto* mesh = std::get_if<std::shared_ptr<const BilinearMesh>>(&shape.geometry))
        return &(*mesh)->positions;
    return nullptr;
}

Bounds3 local_bounds(const ShapeDescription& shape) {
    Bounds3 box;
    if (const auto* points = vertices(shape)) {
        for (const Vec3& p : *points) box.extend(p);
    } else if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
        const float r = sphere->radius;
        box = {{-r, -r, sphere->z_min}, {r, r, sphere->z_max}};
    } else {
        const auto& disk = std::get<Disk>(shape.geometry);
        box = {{-disk.radius, -disk.radius, disk.height}, {disk.radius, disk.radius, disk.height}};
    }
    return box;
}

class PointVisitor {
  public:
    explicit PointVisitor(const std::function<void(Vec3)>& visit) : visit_(visit) {}

    void visit(const ShapeDescription& shape, const Transform& to_world) {
        const Transform map = to_world * shape.object_to_world.start();
        const auto* points = vertices(shape);
        if (points && visited_ + points->size() <= kMostVertices) {
            visited_ += points->size();
            for (const Vec3& p : *points) give(map.point(p));
            return;
        }
        const Bounds3& box = box_of(shape);
        if (box.empty()) return;
        for (const Vec3& p : corners(box)) give(map.point(p));
    }

  private:
    static constexpr size_t kMostVertices = size_t{1} << 22;

    void give(Vec3 p) const {
        if (is_finite(p)) visit_(p);
    }

    const Bounds3& box_of(const ShapeDescription& shape) {
        const auto [entry, is_new] = boxes_.try_emplace(&shape);
        if (is_new) entry->second = local_bounds(shape);
        return entry->second;
    }

    const std::function<void(Vec3)>& visit_;
    size_t visited_ = 0;
    std::map<const ShapeDescription*, Bounds3> boxes_;
};

}  // namespace

void visit_points(const SceneDescription& scene, const std::function<void(Vec3)>& visit) {
    if (!scene.swept.empty()) {
        for (const Vec3& p : corners(scene.swept)) visit(p);
        return;
    }
    PointVisitor visitor(visit);
    for (const ShapeDescription& shape : scene.shapes) visitor.visit(shape, Transform());
    for (const InstanceDescription& instance : scene.instances)
        for (const ShapeDescription& shape :
             scene.objects[static_cast<size_t>(instance.object)].shapes)
            visitor.visit(shape, instance.instance_to_world.start());
}

Bounds3 bounds(const SceneDescription& scene) {
    Bounds3 box;
    visit_points(scene, [&box](Vec3 p) { box.extend(p); });
    return box;
}

}  // namespace covtrace
