#include "pbrt/material_models.h"

#include <cmath>

#include "colour/named_spectra.h"
#include "colour/sigmoid_spectrum.h"
#include "pbrt/brdf_file.h"
#include "pbrt/named_media.h"
#include "pbrt/spectrum_parameter.h"
#include "pbrt/texture_builder.h"
#include "pbrt/version_three.h"
#include "scene/names.h"

namespace covtrace {

namespace {

using Model = decltype(MaterialDescription::value);

struct Builder {
    Entity& e;
    ParameterList& p;
    TextureBuilder& textures;
    BuildContext& context;

    void warn(const std::string& text) const { context.log.add(e.where, text); }

    /// Sets u_roughness and v_roughness: by their own parameters, else "roughness", else
    /// `otherwise`.
    template <typename Material>
    void roughness(Material& m, const std::string& prefix = {}, float otherwise = 0) {
        m.u_roughness = textures.roughness_or_none(p, prefix + "uroughness");
        m.v_roughness = textures.roughness_or_none(p, prefix + "vroughness");
        if (m.u_roughness < 0 || m.v_roughness < 0) {
            const TextureId both = textures.roughness(p, prefix + "roughness", otherwise);
            if (m.u_roughness < 0) m.u_roughness = both;
            if (m.v_roughness < 0) m.v_roughness = both;
        } else {
            // Beside both of its parts it is superfluous, which is no reason for a warning
            p.ignore({prefix + "roughness"});
        }
        m.remap_roughness = p.flag("remaproughness", true);
    }

    DiffuseMaterial diffuse() { return {textures.reflectance(p, "reflectance", Rgb{0.5f})}; }
    /// A metal's model. `outside`: index of the material that covers the metal; the colours of eta
    /// and k are made for the metal's reflectance against it.
    ConductorMaterial conductor(const std::string& prefix, float outside);
    /// Sets a metal's `edge`.
    void metal_edge(ConductorMaterial& m);
    std::optional<ThinFilmDescription> film();
    DielectricMaterial dielectric();
    TextureId gap_albedo();
    CoatedDiffuseMaterial coated_diffuse();
    CoatedConductorMaterial coated_conductor();
    DiffuseTransmissionMaterial diffuse_transmission();
    SubsurfaceMaterial subsurface();
    HairMaterial hair();
};

/// Texture of one of "eta" and "k": a texture or colour as it is, a spectrum as its means per
/// channel.
TextureId index_texture(Builder& b, const Parameter& p) {
    if (p.type == ParameterType::texture || p.type == ParameterType::rgb)
        return b.textures.unbounded(b.p, p.name, Rgb{});
    const auto s = spectrum_value(p, b.context);
    return b.textures.constant(s ? channel_means(*s) : factor_colour(p, b.context), true);
}

Spectrum scaled(Spectrum s, float factor) {
    for (float& v : s.values) v *= factor;
    return s;
}

void Builder::metal_edge(ConductorMaterial& m) {
    // The parameters are ours, not pbrt's: Blender's metals, and its Glossy.
    const std::string edge = p.text("edge", "index");
    if (edge == "schlick") {
        m.edge = ConductorMaterial::Edge::schlick;
        m.edge_tint = textures.reflectance_or_none(p, "edgetint");
    } else if (edge == "none") {
        m.edge = ConductorMaterial::Edge::none;
    } else if (edge != "index") {
        throw Error(ErrorKind::scene, p.where("edge", e.where),
                    unknown_name("edge", edge, {"index", "schlick", "none"}));
    }
    if (m.edge != ConductorMaterial::Edge::of_index && m.reflectance < 0)
        throw Error(ErrorKind::scene, p.where("edge", e.where),
                    "a conductor has an \"edge\" but no \"reflectance\"; expected both");
}

std::optional<ThinFilmDescription> Builder::film() {
    // The parameters are ours, not pbrt's: glTF's iridescence.
    const TextureId thickness = textures.grey_or_none(p, "filmthickness");
    if (thickness < 0) return {};
    return ThinFilmDescription{constant_index(p, "filmeta", 1.33f, context),
                               textures.grey_or_none(p, "filmweight"), thickness};
}

ConductorMaterial Builder::conductor(const std::string& prefix, float outside) {
    ConductorMaterial m;
    roughness(m, prefix);
    // The parameter is ours, not pbrt's: Blender's "Multiscatter GGX".
    m.multiple_scattering = p.flag(prefix + "multiplescattering", false);
    m.reflectance = textures.reflectance_or_none(p, "reflectance");
    if (prefix.empty()) {
        metal_edge(m);
        m.film = film();
    }
    const auto types = {ParameterType::texture, ParameterType::rgb, ParameterType::spectrum,
                        ParameterType::blackbody};
    const Parameter* eta = p.find(prefix + "eta", types);
    const Parameter* k = p.find(prefix + "k", types);
    if (m.reflectance >= 0) {
        if (eta || k)
            throw Error(
                ErrorKind::scene, e.where,
                "a conductor has both \"reflectance\" and \"eta\" or \"k\"; expected one of them");
        return m;
    }
    const auto spectral = [&](const Parameter* given,
                              const char* otherwise) -> std::optional<Spectrum> {
        if (!given) return material_spectrum(otherwise);
        if (given->type == ParameterType::rgb) return unbounded_spectrum(rgb_value(*given));
        if (given->type != ParameterType::spectrum) return std::nullopt;
        std::optional<Spectrum> s = spectrum_value(*given, context);
        // The measured range is extended: an index of 0 outside of it would make a mirror of the
        // metal.
        if (s) s->extends = true;
        return s;
    };
    const auto eta_spectrum = spectral(eta, "metal-Cu-eta");
    const auto k_spectrum = spectral(k, "metal-Cu-k");
    if (eta_spectrum && k_spectrum) {
        const bool is_rgb = eta && eta->type == ParameterType::rgb;
        const Rgb index = is_rgb ? rgb_value(*eta) : channel_means(*eta_spectrum);
        const ConductorColours c =
            conductor_colours(scaled(*eta_spectrum, 1 / outside), scaled(*k_spectrum, 1 / outside),
                              index * (1 / outside));
        m.eta = textures.constant(c.eta * outside, true);
        m.k = textures.constant(c.k * outside, true);
    } else {
        m.eta = eta ? index_texture(*this, *eta)
                    : textures.constant(channel_means(*eta_spectrum), true);
        m.k = k ? index_texture(*this, *k) : textures.constant(channel_means(*k_spectrum), true);
    }
    return m;
}

DielectricMaterial Builder::dielectric() {
    DielectricMaterial m;
    roughness(m);
    RefractiveIndex index = refractive_index(p, "eta", 1.5f, context);
    m.eta = index.eta;
    m.dispersion = std::move(index.dispersion);
    // The parameters are ours, not pbrt's: the colour of glass, as exporters of other models need
    // it, and Blender's "Multiscatter GGX".
    m.transmittance = textures.reflectance_or_none(p, "transmittance");
    m.film = film();
    m.multiple_scattering = p.flag("multiplescattering", false);
    return m;
}

/// Texture of what the gap under a coat scatters; none where that is nothing.
TextureId Builder::gap_albedo() {
    const TextureId albedo = textures.reflectance_or_none(p, "albedo");
    return albedo == textures.constant(Rgb{0}, true) ? -1 : albedo;
}

CoatedDiffuseMaterial Builder::coated_diffuse() {
    CoatedDiffuseMaterial m;
    roughness(m);
    m.reflectance = textures.reflectance(p, "reflectance", Rgb{0.5f});
    m.thickness = textures.grey(p, "thickness", 0.01f);
    m.g = textures.grey(p, "g", 0);
    m.albedo = gap_albedo();
    m.eta = constant_index(p, "eta", 1.5f, context);
    m.max_depth = p.integer("maxdepth", 10);
    m.samples = p.integer("nsamples", 1);
    // The parameter is ours, not pbrt's: diffuse under specular as glTF and Blender have it.
    m.reflects_through_coat = p.flag("reflectsthroughcoat", false);
    if (!m.reflects_through_coat) return m;
    m.normal_reflectance = textures.reflectance_or_none(p, "normalreflectance");
    m.film = film();
    if (m.normal_reflectance < 0 && !m.film)
        m.multiple_scattering = p.flag("multiplescattering", false);
    return m;
}

CoatedConductorMaterial Builder::coated_conductor() {
    CoatedConductorMaterial m;
    m.eta = constant_index(p, "interface.eta", 1.5f, context);
    roughness(m, "interface.");
    m.conductor = conductor("conductor.", m.eta);
    m.thickness = textures.grey(p, "thickness", 0.01f);
    m.g = textures.grey(p, "g", 0);
    m.albedo = gap_albedo();
    m.max_depth = p.integer("maxdepth", 10);
    m.samples = p.integer("nsamples", 1);
    return m;
}

DiffuseTransmissionMaterial Builder::diffuse_transmission() {
    DiffuseTransmissionMaterial m;
    m.reflectance = textures.reflectance(p, "reflectance", Rgb{0.25f});
    m.transmittance = textures.reflectance(p, "transmittance", Rgb{0.25f});
    m.scale = p.number("scale", 1);
    return m;
}

SubsurfaceMaterial Builder::subsurface() {
    SubsurfaceMaterial m;
    m.border.reflects_through_coat = true;
    roughness(m.border);
    m.border.eta = constant_index(p, "eta", 1.33f, context);
    m.scale = p.number("scale", 1);
    if (m.scale < 0)
        throw Error(ErrorKind::scene, p.where("scale", e.where),
                    "parameter \"scale\" of material \"subsurface\" must not be negative");
    m.g = textures.grey_or_none(p, "g");
    // The parameters are ours, not pbrt's: the body under Blender's Principled.
    m.refracts = p.flag("refracts", true);
    m.refracted_share = clamp01(p.number("refractedshare", 0));
    m.facet_eta = std::max(1.0f, p.number("faceteta", 1.4f));
    m.facet_alpha = clamp01(p.number("facetalpha", 1));
    m.border.normal_reflectance = textures.reflectance_or_none(p, "normalreflectance");
    if (m.border.normal_reflectance < 0)
        m.border.multiple_scattering = p.flag("multiplescattering", false);
    // The first of several descriptions counts, as in pbrt: the name, then coefficients, then the
    // reflectance.
    const std::string name = p.text("name");
    if (!name.empty()) {
        const std::optional<NamedMedium> medium = named_medium(name);
        if (!medium)
            throw Error(ErrorKind::scene, p.where("name", e.where),
                        unknown_name("medium", name, medium_names()));
        m.absorption = textures.constant(medium->sigma_a, true);
        m.scattering = textures.constant(medium->sigma_s, true);
        m.g = -1;  // the measured scattering is the reduced one
    } else if (p.has("sigma_a") || p.has("sigma_s") || !p.has("reflectance")) {
        if (p.has("sigma_a") != p.has("sigma_s"))
            throw Error(ErrorKind::scene, e.where,
                        "material \"subsurface\" has one of \"sigma_a\" and \"sigma_s\"; "
                        "expected both or none");
        m.absorption = textures.unbounded(p, "sigma_a", {0.0011f, 0.0024f, 0.014f});
        m.scattering = textures.unbounded(p, "sigma_s", {2.55f, 3.21f, 3.77f});
    } else {
        m.border.reflectance = textures.reflectance_or_none(p, "reflectance");
        m.mean_free_path = textures.unbounded(p, "mfp", Rgb{1});
    }
    p.ignore({"name", "sigma_a", "sigma_s", "reflectance", "mfp", "g"});
    return m;
}

HairMaterial Builder::hair() {
    HairMaterial m;
    // The first of several descriptions counts, as in pbrt: absorption, then the colour, then the
    // pigments.
    std::string first;
    for (const char* name : {"sigma_a", "reflectance", "color", "eumelanin", "pheomelanin"}) {
        if (!p.has(name)) continue;
        if (first.empty())
            first = name;
        else if (first != "eumelanin")
            warn("material \"hair\" has " + in_quotes(first) + ", beside which " + in_quotes(name) +
                 " is ignored");
    }
    if (first == "sigma_a") m.absorption = textures.unbounded(p, first, Rgb{});
    if (first == "reflectance" || first == "color")
        m.reflectance = textures.reflectance_or_none(p, first);
    if (first == "eumelanin" || first == "pheomelanin") {
        m.eumelanin = textures.grey_or_none(p, "eumelanin");
        m.pheomelanin = textures.grey_or_none(p, "pheomelanin");
    }
    p.ignore({"sigma_a", "reflectance", "color", "eumelanin", "pheomelanin"});
    m.beta_m = textures.grey_or_none(p, "beta_m");
    m.beta_n = textures.grey_or_none(p, "beta_n");
    m.alpha = textures.grey_or_none(p, "alpha");
    m.eta = textures.grey_or_none(p, "eta");
    // The parameter is ours, not pbrt's: "Coat" of Blender's Principled Hair.
    m.coat = textures.grey_or_none(p, "haircoat");
    return m;
}

bool is_interface(const std::string& type) {
    return type == "interface" || type.empty() || type == "none";
}

/// The BRDF of a file, read once for all materials that name it.
std::shared_ptr<const BrdfTensor> brdf_of(const std::filesystem::path& file,
                                          const SourceLocation& where, BuildContext& context) {
    for (const MaterialDescription& other : context.scene.materials)
        if (const auto* m = std::get_if<MeasuredMaterial>(&other.value); m && m->brdf->file == file)
            return m->brdf;
    return read_brdf(context.files.read(file, where), file, where);
}

Model measured(Builder& b) {
    const std::string name = b.p.text("filename");
    const SourceLocation where = b.p.where("filename", b.e.where);
    if (name.empty())
        throw Error(ErrorKind::scene, b.e.where,
                    "material \"measured\" has no file; expected \"string filename\"");
    if (const auto file = b.context.files.find_optional(name, where))
        return MeasuredMaterial{brdf_of(*file, where, b.context)};
    b.warn("the measured BRDF " + in_quotes(name) +
           " was not found; a grey \"coateddiffuse\" takes its place");
    Entity plain{"coateddiffuse", {}, b.e.where, b.e.directive};
    return Builder{plain, plain.parameters, b.textures, b.context}.coated_diffuse();
}

}  // namespace

NormalMaps normal_maps(Entity& entity, TextureBuilder& textures, BuildContext& context) {
    ParameterList& p = entity.parameters;
    NormalMaps maps;
    // Only a texture counts: a constant height turns no normal.
    if (const Parameter* height =
            p.find("displacement", {ParameterType::texture, ParameterType::floats});
        height && height->type == ParameterType::texture)
        maps.displacement = textures.grey_of(*height);
    if (const std::string file = p.text("normalmap"); !file.empty()) {
        const SourceLocation where = p.where("normalmap", entity.where);
        ImageTexture image;
        image.file = context.files.find(file, where);
        image.encoding = ImageTexture::Encoding::linear;
        image.is_colour = false;
        maps.normal_map = static_cast<TextureId>(context.scene.textures.size());
        context.scene.textures.push_back({{}, true, image, where});
    }
    maps.follow_uv = p.flag("mapsfollowuv", false);
    maps.bump_strength = p.number("bumpstrength", 1);
    if (!(maps.bump_strength >= 0 && maps.bump_strength <= 1000))
        throw Error(ErrorKind::scene, p.where("bumpstrength", entity.where),
                    "a \"bumpstrength\" is out of range; expected a number from 0 to 1000");
    return maps;
}

MaterialLayers material_layers(Entity& entity, TextureBuilder& textures, BuildContext& context) {
    constexpr float kSheenRoughness = 0.25f;  // that of Blender's Principled, squared
    constexpr float kCoatIndex = 1.5f;        // that of Blender's Principled
    MaterialLayers layers;
    if (is_interface(entity.type)) return layers;
    ParameterList& p = entity.parameters;
    if (const TextureId colour = textures.reflectance_or_none(p, "sheen"); colour >= 0)
        layers.sheen = SheenLayer{colour, textures.roughness(p, "sheenroughness", kSheenRoughness)};
    if (const TextureId weight = textures.grey_or_none(p, "coat"); weight >= 0) {
        ClearcoatLayer coat;
        coat.weight = weight;
        coat.alpha = textures.roughness(p, "coatroughness", 0);
        coat.eta = constant_index(p, "coateta", kCoatIndex, context);
        coat.tint = textures.reflectance_or_none(p, "coattint");
        layers.clearcoat = coat;
    }
    return layers;
}

Model material_model(Entity& entity, TextureBuilder& textures, BuildContext& context) {
    Builder b{entity, entity.parameters, textures, context};
    const std::string& type = entity.type;
    Model model;
    if (type == "diffuse") {
        model = b.diffuse();
    } else if (type == "coateddiffuse") {
        model = b.coated_diffuse();
    } else if (type == "conductor") {
        model = b.conductor("", 1);
    } else if (type == "dielectric") {
        model = b.dielectric();
    } else if (type == "diffusetransmission") {
        model = b.diffuse_transmission();
    } else if (type == "coatedconductor") {
        model = b.coated_conductor();
    } else if (type == "thindielectric") {
        ThinDielectricMaterial pane{constant_index(b.p, "eta", 1.5f, context),
                                    textures.reflectance_or_none(b.p, "transmittance")};
        pane.film = b.film();
        model = pane;
    } else if (type == "subsurface") {
        model = b.subsurface();
    } else if (type == "hair") {
        model = b.hair();
    } else if (type == "measured") {
        model = measured(b);
    } else if (is_interface(type)) {
        model = InterfaceMaterial{};
    } else {
        throw unknown_type_error(entity.where, "material", type,
                                 {"diffuse", "coateddiffuse", "conductor", "dielectric",
                                  "diffusetransmission", "coatedconductor", "thindielectric",
                                  "subsurface", "hair", "measured", "mix", "interface"});
    }
    b.p.warn_unused(context.log, "material " + in_quotes(type));
    return model;
}

}  // namespace covtrace
