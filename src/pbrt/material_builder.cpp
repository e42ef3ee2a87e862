#include "pbrt/material_builder.h"

#include "pbrt/material_models.h"
#include "pbrt/texture_builder.h"
#include "scene/names.h"

namespace covtrace {

namespace {
constexpr int kDeepestMix = 256;
constexpr float kMostWeight = 1000;  // of a mix; more is no sum of surfaces, but noise alone
}  // namespace

MaterialBuilder::MaterialBuilder(BuildContext& context, TextureBuilder& textures)
    : context_(context), textures_(textures) {
    declare({"diffuse", {}, {}, 0});
}

void MaterialBuilder::declare_named(std::string name, Entity entity) {
    const auto [it, is_new] = by_name_.try_emplace(name, declared_.size());
    if (!is_new)
        throw Error(ErrorKind::scene, entity.where,
                    "material " + in_quotes(name) + " is already defined at " +
                        declared_[it->second].entity.where.to_string());
    entity.type = entity.parameters.text("type");
    if (entity.type.empty() && !entity.parameters.has("type"))
        throw Error(ErrorKind::scene, entity.where,
                    "material " + in_quotes(name) + " has no type; expected \"string type\"");
    declared_.push_back({std::move(name), std::move(entity), -1, false});
}

size_t MaterialBuilder::declare(Entity entity) {
    unnamed_.push_back(declared_.size());
    declared_.push_back({{}, std::move(entity), -1, false});
    return unnamed_.size() - 1;
}

void MaterialBuilder::build_all() {
    for (Declared& d : declared_) build(d);
}

MaterialId MaterialBuilder::find(const MaterialReference& reference) {
    if (reference.name.empty()) return build(declared_[unnamed_[reference.index]]);
    const auto it = by_name_.find(reference.name);
    if (it != by_name_.end()) return build(declared_[it->second]);
    std::vector<std::string> known;
    for (const auto& [name, index] : by_name_) known.push_back(name);
    throw Error(ErrorKind::scene, reference.where,
                "material " + in_quotes(reference.name) + " is not defined" +
                    did_you_mean(reference.name, known));
}

namespace {

/// Whether surfaces of a type can lie under layers (has_layers of src/shading/material_layers.h).
bool bears_layers(const std::string& type) {
    return type != "hair" && type != "diffusetransmission" && type != "coatedconductor" &&
           type != "measured";
}

/// For materials without layers: warns once of what asks for them.
MaterialLayers no_layers(Entity& entity, BuildContext& context) {
    ParameterList& p = entity.parameters;
    std::string names;
    SourceLocation where = entity.where;
    for (const char* name : {"coat", "sheen"}) {
        if (!p.has(name)) continue;
        if (names.empty()) where = p.where(name, where);
        names += (names.empty() ? "" : " and ") + in_quotes(name);
    }
    if (names.empty()) return {};
    context.log.add(where, "a material " + in_quotes(entity.type) + " has no layers; " + names +
                               (names.find(" and ") == std::string::npos ? " is" : " are") +
                               " ignored");
    p.ignore({"coat", "coatroughness", "coateta", "coattint", "sheen", "sheenroughness"});
    return {};
}

}  // namespace

MaterialId MaterialBuilder::build(Declared& d) {
    if (d.id >= 0) return d.id;
    if (d.in_progress)
        throw Error(ErrorKind::scene, d.entity.where,
                    "material " + in_quotes(d.name) + " mixes itself");
    if (++depth_ > kDeepestMix)
        throw Error(ErrorKind::scene, d.entity.where,
                    "materials mix materials in too long a chain");
    d.in_progress = true;
    context_.log.set_order(d.entity.directive);
    if (d.entity.type == "mix") {
        d.id = build_mix(d);
    } else {
        const MaterialLayers layers = bears_layers(d.entity.type)
                                          ? material_layers(d.entity, textures_, context_)
                                          : no_layers(d.entity, context_);
        const NormalMaps maps = normal_maps(d.entity, textures_, context_);
        MaterialDescription m{d.name,
                              material_model(d.entity, textures_, context_),
                              d.entity.where,
                              {},
                              maps.displacement,
                              maps.normal_map};
        m.maps_follow_uv = maps.follow_uv;
        m.bump_strength = maps.bump_strength;
        m.sheen = layers.sheen;
        m.clearcoat = layers.clearcoat;
        d.id = static_cast<MaterialId>(context_.scene.materials.size());
        context_.scene.materials.push_back(std::move(m));
    }
    d.in_progress = false;
    --depth_;
    return d.id;
}

MaterialId MaterialBuilder::build_mix(Declared& d) {
    ParameterList& p = d.entity.parameters;
    const SourceLocation where = p.where("materials", d.entity.where);
    const std::vector<std::string> parts = p.texts("materials");
    if (parts.size() != 2)
        throw Error(ErrorKind::scene, where,
                    "a mix expects the names of two materials in \"string materials\"");
    MaterialMix mix;
    mix.amount = textures_.grey(p, "amount", 0.5f);
    mix.weight = p.number("weight", 1);
    if (!(mix.weight >= 0 && mix.weight <= kMostWeight))
        d.entity.refuse("weight", "parameter \"weight\" of a mix must be between 0 and " +
                                      std::to_string(static_cast<int>(kMostWeight)));
    p.warn_unused(context_.log, "material \"mix\"");
    for (size_t i = 0; i < 2; ++i) mix.materials[i] = find({parts[i], 0, where});
    const auto id = static_cast<MaterialId>(context_.scene.materials.size());
    context_.scene.materials.push_back({d.name, DiffuseMaterial{}, d.entity.where, mix});
    return id;
}

}  // namespace covtrace
