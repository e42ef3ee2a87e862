#include "integrator/lit_scene.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "core/error.h"
#include "integrator/displacement.h"
#include "integrator/glow_alone.h"
#include "integrator/lamps.h"
#include "integrator/open_walls.h"

namespace covtrace {

namespace {

bool anything_moves(const SceneDescription& d) {
    const auto shape_moves = [](const ShapeDescription& s) {
        return s.object_to_world.is_animated();
    };
    return d.camera.camera_to_world.is_animated() ||
           std::any_of(d.shapes.begin(), d.shapes.end(), shape_moves) ||
           std::any_of(
               d.instances.begin(), d.instances.end(),
               [](const InstanceDescription& i) { return i.instance_to_world.is_animated(); }) ||
           std::any_of(d.objects.begin(), d.objects.end(), [&](const ObjectDescription& o) {
               return std::any_of(o.shapes.begin(), o.shapes.end(), shape_moves);
           });
}

bool holds_out(const SceneDescription& d) {
    const auto any_of = [](const std::vector<ShapeDescription>& shapes) {
        return std::any_of(shapes.begin(), shapes.end(),
                           [](const ShapeDescription& s) { return s.is_holdout; });
    };
    return any_of(d.shapes) ||
           std::any_of(d.objects.begin(), d.objects.end(),
                       [&](const ObjectDescription& o) { return any_of(o.shapes); });
}

/// Radius of a sphere around the shapes that, where the camera is in a medium, holds the camera and
/// all lights with a place, too: their rays must reach each other before the medium ends.
float radius_of_media(const SceneDescription& d, const Bounds3& shapes) {
    float radius = shapes.radius();
    if (d.camera.medium < 0 || shapes.empty()) return radius;
    const auto hold = [&](Vec3 p) { radius = std::max(radius, length(p - shapes.center())); };
    hold(d.camera.camera_to_world.start().point({}));
    hold(d.camera.camera_to_world.end().point({}));
    for (const LightDescription& light : d.lights) {
        if (const auto* point = std::get_if<PointLight>(&light.value))
            hold(light.light_to_world.point(point->from));
        else if (const auto* spot = std::get_if<SpotLight>(&light.value))
            hold(light.light_to_world.point(spot->from));
        else if (std::holds_alternative<GoniometricLight>(light.value) ||
                 std::holds_alternative<ProjectionLight>(light.value))
            hold(light.light_to_world.point({}));
    }
    return radius;
}

}  // namespace

bool may_tell_opacity(const SceneDescription& scene) {
    return !scene.media.empty() || holds_out(scene);
}

LitScene::LitScene(SceneDescription scene_description, const std::string& isa, size_t texture_bytes)
    : description(std::move(scene_description)),
      textures(description, texture_bytes),
      geometry(displace(description, textures), isa),
      lights(lit_description(isa), geometry, &textures),
      materials(description, textures,
                description.adapts_colours ? IlluminantAdaptation(lights.total_power())
                                           : IlluminantAdaptation()),
      camera(description.camera, description.film.width, description.film.height),
      filter(description.filter) {
    lights.set_layers([this](MaterialId id) { return materials.has_layers(id); },
                      [this](MaterialId id, const TexturePoint& at, float cosine) {
                          return materials.emission_share(id, at, cosine, textures);
                      });
    for (const Warnings* w : {&textures.warnings(), &lights.warnings()})
        description.warnings.insert(description.warnings.end(), w->begin(), w->end());
    for (const MediumDescription& m : description.media)
        media.push_back({m.sigma_a, m.sigma_s, m.emission, m.g, m.density.get(), m.glow.get(),
                         m.source.get(), m.is_seen});
    has_lens_or_motion = camera.has_lens() || anything_moves(description);
    has_interfaces = geometry.has_interfaces();
    shadows_differ = geometry.shadows_differ();
    kinds_differ = shadows_differ || geometry.kinds_differ() || lights.kinds_differ();
    has_holes = holds_out(description) || !lights.has_sky_for(RayKind::camera);
    tells_opacity = has_holes && may_tell_opacity(description);
    samples_through_panes = geometry.has_panes() && !kinds_differ;
    if (!kinds_differ) mirrors = FlatMirrors(description, geometry);
    samples_by_mirrors = !mirrors.is_empty();
    unbounded_distance = 2 * radius_of_media(description, geometry.bounds());
}

const SceneDescription& LitScene::lit_description(const std::string& isa) {
    const AlphaLookup alpha = [this](TextureId id, const AlphaPlace& at) {
        return textures.eval_float(id, {at.uv, at.position, {}, at.normal, at.vertices, at.facing});
    };
    geometry.set_alpha(alpha);
    light_glow_alone(description, geometry, textures);
    has_open_walls = open_walls(description, geometry, textures);
    if (has_open_walls) {
        // The memory of the one with walls is free before the other one is built
        { const Geometry with_walls = std::move(geometry); }
        geometry = Geometry(description, isa);
        geometry.set_alpha(alpha);
    }
    return stand_lamps(description, geometry, textures);
}

void LitScene::throw_if_interrupted() const {
    if (is_interrupted && is_interrupted())
        throw Error(ErrorKind::interrupted, "interrupted before the scene was ready");
}

std::map<std::string, size_t> LitScene::memory() const {
    const auto bytes = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
    const auto mesh_bytes = [&](const auto& mesh, const auto& faces) {
        return bytes(mesh.positions) + bytes(mesh.normals) + bytes(mesh.uvs) + bytes(faces);
    };
    const auto vertex_value_bytes = [&](const TriangleMesh& mesh) {
        size_t sum = bytes(mesh.colours) + bytes(mesh.colour_steps);
        for (const auto& uvs : mesh.more_uvs) sum += bytes(uvs);
        return sum;
    };
    std::map<const void*, size_t> meshes;  // shapes share meshes
    for (const PlacedShape& shape : geometry.shapes()) {
        const auto& g = shape.description.geometry;
        if (const auto* triangles = std::get_if<std::shared_ptr<const TriangleMesh>>(&g))
            meshes[triangles->get()] =
                mesh_bytes(**triangles, (*triangles)->triangles) + vertex_value_bytes(**triangles);
        else if (const auto* patches = std::get_if<std::shared_ptr<const BilinearMesh>>(&g))
            meshes[patches->get()] = mesh_bytes(**patches, (*patches)->patches);
    }
    size_t sum = 0, grids = 0;
    for (const auto& [mesh, size] : meshes) sum += size;
    for (const MediumDescription& m : description.media) {
        if (m.density) grids += m.density->bytes();
        if (m.glow) grids += m.glow->field->bytes();
        if (m.glow && m.glow->factor) grids += m.glow->factor->bytes();
        if (m.source) grids += m.source->bytes();
    }
    return {{"meshes", sum},
            {"shapes", geometry.memory()},
            {"embree", geometry.embree_memory()},
            {"textures", textures.memory()},
            {"media", grids}};
}

}  // namespace covtrace
