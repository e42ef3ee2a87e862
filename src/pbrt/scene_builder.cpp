#include "pbrt/scene_builder.h"

#include <algorithm>

#include "pbrt/light_builder.h"
#include "pbrt/medium_builder.h"
#include "pbrt/ray_visibility.h"
#include "scene/names.h"

namespace covtrace {

namespace {

/// Whether a shape of this type has its outside on the inner side. A mirror turns spheres, disks
/// and cylinders inside out, as in pbrt-v4, and ReverseOrientation turns them back: exporters write
/// both. Lamps go by ReverseOrientation alone, as they do for pbrt-v4's samples of lights, though
/// not for its rays.
bool is_inside_out(const std::string& type, const ShapeDescription& shape, bool is_reversed) {
    const bool is_quadric = type == "sphere" || type == "disk" || type == "cylinder";
    const bool is_mirrored = is_quadric && shape.area_light < 0 &&
                             !shape.object_to_world.is_animated() &&
                             shape.object_to_world.start().swaps_handedness();
    return is_reversed != is_mirrored;
}

}  // namespace

SceneBuilder::SceneBuilder(SceneDescription& scene, SceneFiles& files, WarningLog& log)
    : scene_(scene),
      context_{scene, files, log},
      textures_(context_),
      materials_(context_, textures_),
      shapes_(context_) {}

void SceneBuilder::camera(Entity entity) {
    view_.camera_medium = state_.outside_medium;
    view_.camera_to_world = state_.world_to_object(entity.where);
    coordinate_systems_["camera"] = {state_.ctm[0].get(entity.where).inverse(),
                                     state_.ctm[1].get(entity.where).inverse()};
    view_.camera = std::move(entity);
}

void SceneBuilder::film(Entity entity) {
    view_.film = std::move(entity);
    view_.film_colour_space = state_.colour_space;
}

void SceneBuilder::world_begin() {
    in_world_ = true;
    state_.ctm = {};
    state_.active = {true, true};
    coordinate_systems_["world"] = state_.ctm;
    build_view(view_, context_);
    begin_directive();
}

void SceneBuilder::use_coordinate_system(const std::string& name, const SourceLocation& where) {
    const auto it = coordinate_systems_.find(name);
    if (it != coordinate_systems_.end()) {
        state_.ctm = it->second;
        return;
    }
    std::vector<std::string> known;
    for (const auto& [n, transforms] : coordinate_systems_) known.push_back(n);
    throw Error(
        ErrorKind::scene, where,
        "coordinate system " + in_quotes(name) + " is not defined" + did_you_mean(name, known));
}

void SceneBuilder::named_material(std::string name, Entity entity) {
    materials_.declare_named(std::move(name), std::move(entity));
}

void SceneBuilder::material(Entity entity) {
    const SourceLocation where = entity.where;
    state_.material = {{}, materials_.declare(std::move(entity)), where};
}

void SceneBuilder::use_named_material(std::string name, const SourceLocation& where) {
    if (name.empty()) throw Error(ErrorKind::scene, where, "NamedMaterial has an empty name");
    state_.material = {std::move(name), 0, where};
}

void SceneBuilder::medium(std::string name, Entity entity) {
    for (const MediumDescription& m : scene_.media)
        if (m.name == name)
            throw Error(
                ErrorKind::scene, entity.where,
                "medium " + in_quotes(name) + " is already defined at " + m.where.to_string());
    scene_.media.push_back(build_medium(std::move(name), entity, state_.ctm[0], context_));
}

void SceneBuilder::texture(std::string name, bool is_spectrum, Entity entity) {
    textures_.declare(std::move(name), is_spectrum, std::move(entity), state_.ctm[0]);
}

void SceneBuilder::attribute(const std::string& target, std::vector<Parameter> parameters,
                             const SourceLocation& where) {
    const auto it = state_.attributes.find(target);
    if (it == state_.attributes.end())
        throw Error(ErrorKind::scene, where,
                    unknown_name("attribute target", target,
                                 {"shape", "light", "material", "medium", "texture"}));
    for (Parameter& p : parameters) it->second.add(std::move(p));
}

void SceneBuilder::save(Scope scope, const SourceLocation& where) {
    saved_.push_back({scope, where, state_});
}

void SceneBuilder::attribute_begin(const SourceLocation& where) {
    save(Scope::attribute, where);
}

void SceneBuilder::attribute_end(const SourceLocation& where) {
    if (saved_.empty() || saved_.back().scope == Scope::import) {
        context_.log.add(where, "AttributeEnd without AttributeBegin; ignored");
        return;
    }
    if (saved_.back().scope == Scope::object)
        throw Error(ErrorKind::scene, where,
                    "AttributeEnd where ObjectEnd is expected, for the ObjectBegin at " +
                        saved_.back().where.to_string());
    state_ = std::move(saved_.back().state);
    saved_.pop_back();
}

void SceneBuilder::object_begin(const std::string& name, const SourceLocation& where) {
    if (object_ >= 0)
        throw Error(ErrorKind::scene, where,
                    "ObjectBegin inside of the object " +
                        in_quotes(scene_.objects[static_cast<size_t>(object_)].name));
    if (!objects_by_name_.try_emplace(name, static_cast<int>(scene_.objects.size())).second)
        throw Error(ErrorKind::scene, where, "object " + in_quotes(name) + " is already defined");
    save(Scope::object, where);
    object_ = static_cast<int>(scene_.objects.size());
    scene_.objects.push_back({name, {}});
}

void SceneBuilder::object_end(const SourceLocation& where) {
    if (object_ < 0 || saved_.empty())
        throw Error(ErrorKind::scene, where, "ObjectEnd without ObjectBegin");
    if (saved_.back().scope != Scope::object)
        throw Error(ErrorKind::scene, where,
                    "ObjectEnd where the block that begins at " + saved_.back().where.to_string() +
                        " is still open");
    state_ = std::move(saved_.back().state);
    saved_.pop_back();
    object_ = -1;
}

void SceneBuilder::object_instance(const std::string& name, const SourceLocation& where) {
    if (object_ >= 0)
        throw Error(ErrorKind::scene, where,
                    "ObjectInstance inside of an object; objects can't hold instances");
    scene_.instances.push_back({-1, state_.object_to_world(where), where});
    instance_names_.push_back(name);
}

void SceneBuilder::light(Entity entity) {
    if (!(state_.ctm[0] == state_.ctm[1]))
        context_.log.add(entity.where,
                         "moving lights are not supported; the light stays where it starts");
    scene_.lights.push_back(build_light(entity, state_.ctm[0].get(entity.where), context_));
}

void SceneBuilder::area_light(Entity entity) {
    state_.area_light = static_cast<int>(scene_.area_lights.size());
    if (const Parameter* radiance = entity.parameters.find("radiance", {ParameterType::texture})) {
        if (entity.parameters.has("filename"))
            entity.refuse("radiance",
                          "an area light has both \"filename\" and \"radiance\"; "
                          "expected one of them");
        radiances_.emplace(state_.area_light, *radiance);
    }
    scene_.area_lights.push_back(build_area_light(entity, context_));
}

void SceneBuilder::shape(Entity entity) {
    PendingShape pending;
    pending.object = object_;
    pending.material = state_.material;
    if (!pending.material.where.file) pending.material.where = entity.where;
    pending.inside = state_.inside_medium;
    pending.outside = state_.outside_medium;
    pending.directive = directive_;
    if (const Parameter* alpha =
            entity.parameters.find("alpha", {ParameterType::floats, ParameterType::texture}))
        pending.alpha = *alpha;
    if (entity.type == "plymesh") {
        pending.edge_length = entity.parameters.number("edgelength", 1);
        if (const Parameter* height =
                entity.parameters.find("displacement", {ParameterType::texture}))
            pending.displacement = *height;
        if (!(pending.edge_length > 0))
            entity.refuse("edgelength", "parameter \"edgelength\" must be greater than 0");
    }
    ShapeDescription& s = pending.shape;
    s.object_to_world = state_.object_to_world(entity.where);
    s.where = entity.where;
    s.directive = directive_;
    s.visible_to = visible_to(entity);
    s.is_holdout = entity.parameters.flag("holdout", false);
    s.area_light = state_.area_light;
    if (s.area_light >= 0) {
        used_area_lights_.insert(s.area_light);
        if (object_ >= 0) {
            context_.log.add(entity.where, "area lights inside of objects are ignored");
            s.area_light = -1;
        }
    }
    s.reverse_orientation = is_inside_out(entity.type, s, state_.reverse_orientation);
    BuiltShape built = shapes_.build(entity);
    s.tube_sides = built.tube_sides;
    pending.mesh_file = built.mesh_file;
    if (built.mesh_file) pending_.push_back(pending);
    for (ShapeGeometry& geometry : built.geometry) {
        pending.shape.geometry = std::move(geometry);
        pending_.push_back(pending);
    }
}

void SceneBuilder::place_meshes() {
    shapes_.read_mesh_files();
    std::vector<PendingShape> placed;
    placed.reserve(pending_.size());
    for (PendingShape& p : pending_) {
        if (!p.mesh_file) {
            placed.push_back(std::move(p));
            continue;
        }
        const std::vector<ShapeGeometry> meshes =
            shapes_.mesh(*p.mesh_file, p.displacement.has_value());
        if (meshes.empty()) {
            context_.log.set_order(p.directive);
            context_.log.add(p.shape.where, "the mesh file has no faces; the shape is ignored");
        }
        for (const ShapeGeometry& geometry : meshes) {
            placed.push_back(p);
            placed.back().shape.geometry = geometry;
        }
    }
    pending_ = std::move(placed);
}

void SceneBuilder::import_begin(const SourceLocation& where) {
    save(Scope::import, where);
}

void SceneBuilder::import_end() {
    if (saved_.back().scope != Scope::import)
        throw Error(ErrorKind::scene, saved_.back().where,
                    "this block is not closed in the imported file");
    state_ = std::move(saved_.back().state);
    saved_.pop_back();
}

MediumId SceneBuilder::medium_named(const std::string& name, const SourceLocation& where) const {
    if (name.empty()) return -1;
    std::vector<std::string> known;
    for (size_t i = 0; i < scene_.media.size(); ++i) {
        if (scene_.media[i].name == name) return static_cast<MediumId>(i);
        known.push_back(scene_.media[i].name);
    }
    throw Error(ErrorKind::scene, where,
                "medium " + in_quotes(name) + " is not defined" + did_you_mean(name, known));
}

void SceneBuilder::drop_media() {
    bool used = scene_.camera.medium >= 0;
    scene_.camera.medium = -1;
    const auto drop = [&used](std::vector<ShapeDescription>& shapes) {
        for (ShapeDescription& s : shapes) {
            used |= s.inside != s.outside;
            s.inside = s.outside = -1;
        }
    };
    drop(scene_.shapes);
    for (ObjectDescription& o : scene_.objects) drop(o.shapes);
    if (!used) return;
    context_.log.set_order(view_.integrator.directive);
    context_.log.add(view_.integrator.where,
                     "integrator " + in_quotes(view_.integrator.type) +
                         " sees no media, as in pbrt; \"volpath\" renders them");
}

bool SceneBuilder::resolve_alpha(PendingShape& pending) {
    if (!pending.alpha) return true;
    ShapeDescription& s = pending.shape;
    s.alpha = textures_.grey_of(*pending.alpha);
    if (pending.alpha->type == ParameterType::texture) return true;
    const float value = textures_.mean(s.alpha).r;
    if (value >= 1) s.alpha = -1;
    // An invisible shape is kept where it emits: it still lights the scene.
    return value > 0 || s.area_light >= 0;
}

void SceneBuilder::resolve_displacement(PendingShape& pending) {
    if (!pending.displacement) return;
    ShapeDescription& s = pending.shape;
    const auto& mesh = std::get<std::shared_ptr<const TriangleMesh>>(s.geometry);
    if (mesh->uvs.empty())
        throw Error(ErrorKind::scene, pending.displacement->where,
                    "the mesh can't be displaced; expected one whose vertices have u and v");
    const float longest = pending.edge_length * displacement_edge_scale_;
    s.displacement = Displacement{textures_.grey_of(*pending.displacement), longest};
}

void SceneBuilder::resolve(PendingShape& pending) {
    context_.log.set_order(pending.directive);
    ShapeDescription& s = pending.shape;
    s.material = materials_.find(pending.material);
    s.inside = medium_named(pending.inside, s.where);
    s.outside = medium_named(pending.outside, s.where);
    const auto& material = scene_.materials[static_cast<size_t>(s.material)].value;
    if (s.area_light >= 0 && std::holds_alternative<InterfaceMaterial>(material)) {
        context_.log.add(s.where,
                         "area lights on shapes with the material \"interface\" are ignored");
        s.area_light = -1;
    }
    if (s.visible_to != kEveryRay && std::holds_alternative<InterfaceMaterial>(material)) {
        context_.log.add(
            s.where,
            "\"hiddenfrom\" is ignored on shapes with the material \"interface\": media "
            "end there for every ray");
        s.visible_to = kEveryRay;
    }
    // A shape that lets light pass is no border between media, either.
    if (s.area_light >= 0 && scene_.area_lights[static_cast<size_t>(s.area_light)].lets_light_pass)
        s.inside = s.outside = -1;
    if (!resolve_alpha(pending)) return;
    resolve_displacement(pending);
    auto& shapes = pending.object < 0 ? scene_.shapes
                                      : scene_.objects[static_cast<size_t>(pending.object)].shapes;
    shapes.push_back(std::move(s));
}

void SceneBuilder::finish(const SourceLocation& end) {
    if (!in_world_) throw Error(ErrorKind::scene, end, "the scene ends before WorldBegin");
    if (!saved_.empty())
        throw Error(
            ErrorKind::scene, saved_.back().where,
            std::string(saved_.back().scope == Scope::object ? "ObjectBegin" : "AttributeBegin") +
                " has no matching end");
    place_meshes();
    textures_.build_all();
    materials_.build_all();
    for (const auto& [light, texture] : radiances_)
        scene_.area_lights[static_cast<size_t>(light)].image = textures_.coloured(texture);
    scene_.camera.medium = medium_named(view_.camera_medium, scene_.camera.where);
    for (PendingShape& p : pending_) resolve(p);
    if (!scene_.renders_media) drop_media();
    for (size_t i = 0; i < scene_.instances.size(); ++i) {
        InstanceDescription& instance = scene_.instances[i];
        const auto it = objects_by_name_.find(instance_names_[i]);
        if (it != objects_by_name_.end()) {
            instance.object = it->second;
            continue;
        }
        std::vector<std::string> known;
        for (const auto& [name, index] : objects_by_name_) known.push_back(name);
        throw Error(ErrorKind::scene, instance.where,
                    "object " + in_quotes(instance_names_[i]) + " is not defined" +
                        did_you_mean(instance_names_[i], known));
    }
    for (size_t i = 0; i < scene_.area_lights.size(); ++i)
        if (!used_area_lights_.contains(static_cast<int>(i)))
            context_.log.add(scene_.area_lights[i].where, "the area light has no shape");
    note_what_is_missing(end);
}

void SceneBuilder::note_what_is_missing(const SourceLocation& end) {
    const SourceLocation file{end.file, 0, 0};
    if (!view_.camera.where.file)
        scene_.no_camera = {file,
                            "the scene has no Camera; as in pbrt-v4, one of 90 degrees at the "
                            "origin looks along +z"};
    const bool has_emitters =
        std::any_of(scene_.shapes.begin(), scene_.shapes.end(),
                    [](const ShapeDescription& s) { return s.area_light >= 0; }) ||
        std::any_of(scene_.media.begin(), scene_.media.end(), [](const MediumDescription& m) {
            return !is_black(m.emission) || m.glow || m.source;
        });
    const bool is_empty = scene_.shapes.empty() && scene_.instances.empty();
    if (!is_empty && scene_.lights.empty() && !has_emitters)
        scene_.no_lights = {file,
                            "the scene has no lights, and pbrt-v4 renders it black; a grey sky and "
                            "a key light from the upper left of the camera light it, unless an "
                            "environment is given (0 is black)"};
}

}  // namespace covtrace
