/// Carries out the directives of a scene file one after another and collects the description.
///
/// Geometry, lights and media are built at once; textures, materials and every reference by name
/// wait for `finish`, since names may be used before they are defined.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "pbrt/build_context.h"
#include "pbrt/graphics_state.h"
#include "pbrt/material_builder.h"
#include "pbrt/shape_builder.h"
#include "pbrt/texture_builder.h"
#include "pbrt/view_builder.h"

namespace covtrace {

class SceneBuilder {
  public:
    SceneBuilder(SceneDescription& scene, SceneFiles& files, WarningLog& log);

    GraphicsState& state() { return state_; }
    bool in_world() const { return in_world_; }

    void begin_directive() { context_.log.set_order(++directive_); }

    // Directives that stand before WorldBegin.
    void camera(Entity entity);
    void film(Entity entity);
    void filter(Entity entity) { view_.filter = std::move(entity); }
    void sampler(Entity entity) { view_.sampler = std::move(entity); }
    void integrator(Entity entity) { view_.integrator = std::move(entity); }
    void accelerator(Entity entity) { view_.accelerator = std::move(entity); }
    void world_begin();

    // Directives that name something.
    void coordinate_system(const std::string& name) { coordinate_systems_[name] = state_.ctm; }
    void use_coordinate_system(const std::string& name, const SourceLocation& where);
    void named_material(std::string name, Entity entity);
    void material(Entity entity);
    void use_named_material(std::string name, const SourceLocation& where);
    void medium(std::string name, Entity entity);
    void texture(std::string name, bool is_spectrum, Entity entity);
    void attribute(const std::string& target, std::vector<Parameter> parameters,
                   const SourceLocation& where);

    // Directives that stand in the world.
    void attribute_begin(const SourceLocation& where);
    void attribute_end(const SourceLocation& where);
    void object_begin(const std::string& name, const SourceLocation& where);
    void object_end(const SourceLocation& where);
    void object_instance(const std::string& name, const SourceLocation& where);
    void light(Entity entity);
    void area_light(Entity entity);
    void shape(Entity entity);

    /// A factor on the lengths that displaced meshes' edges are split to.
    void scale_displacement_edges(float scale) { displacement_edge_scale_ = scale; }

    /// Imported files see the state, but leave it as it was.
    void import_begin(const SourceLocation& where);
    void import_end();

    /// Resolves all names and completes the description. Errors: Error(scene).
    void finish(const SourceLocation& end);

    int directive() const { return directive_; }

  private:
    enum class Scope { attribute, object, import };
    struct Saved {
        Scope scope;
        SourceLocation where;
        GraphicsState state;
    };
    /// A shape whose material, alpha and media are still names.
    struct PendingShape {
        ShapeDescription shape;
        int object = -1;  ///< -1: in the world
        MaterialReference material;
        std::optional<Parameter> alpha;
        std::optional<Parameter> displacement;  ///< texture of a plymesh
        float edge_length = 1;
        std::string inside, outside;
        std::optional<size_t> mesh_file;  ///< file whose geometry it still waits for
        int directive = 0;
    };

    void save(Scope scope, const SourceLocation& where);
    void resolve(PendingShape& pending);
    /// Replaces the shapes that wait for mesh files by the geometry of these.
    void place_meshes();
    /// Reads a shape's alpha; false where nothing of the shape has any effect.
    bool resolve_alpha(PendingShape& pending);
    void resolve_displacement(PendingShape& pending);
    /// Leaves out all media, for integrators that see none.
    void drop_media();
    /// Notes where the file has no camera, or nothing that emits light.
    void note_what_is_missing(const SourceLocation& end);
    MediumId medium_named(const std::string& name, const SourceLocation& where) const;

    SceneDescription& scene_;
    BuildContext context_;
    TextureBuilder textures_;
    MaterialBuilder materials_;
    ShapeBuilder shapes_;
    ViewEntities view_;
    GraphicsState state_;
    std::vector<Saved> saved_;
    std::map<std::string, TransformPair> coordinate_systems_;
    std::vector<PendingShape> pending_;
    std::map<std::string, int> objects_by_name_;
    std::vector<std::string> instance_names_;
    std::set<int> used_area_lights_;
    std::map<int, Parameter> radiances_;  ///< textures that multiply that of area lights
    int object_ = -1;                     ///< open object definition
    bool in_world_ = false;
    int directive_ = 0;
    float displacement_edge_scale_ = 1;
};

}  // namespace covtrace
