#include "pbrt/texture_builder.h"

#include <algorithm>
#include <cctype>
#include <optional>

#include "pbrt/spectrum_parameter.h"
#include "pbrt/texture_parameters.h"
#include "pbrt/version_three.h"
#include "scene/names.h"

namespace covtrace {

namespace {

/// Longest chain of textures that refer to textures; a longer one is a mistake.
constexpr int kDeepestChain = 256;

Rgb mean_of(Rgb a, Rgb b) {
    return 0.5f * (a + b);
}

/// The kind of noise of a type of texture: marble is a colour, the others are numbers. Empty for
/// other types.
std::optional<NoiseTexture::Kind> noise_kind(std::string_view type, bool is_spectrum) {
    using Kind = NoiseTexture::Kind;
    if (is_spectrum) return type == "marble" ? std::optional(Kind::marble) : std::nullopt;
    if (type == "fbm") return Kind::fbm;
    if (type == "wrinkled") return Kind::wrinkled;
    if (type == "windy") return Kind::windy;
    return std::nullopt;
}

/// Mean of noise, measured on pbrt-v4's noise with its default parameters.
Rgb mean_of_noise(NoiseTexture::Kind kind) {
    if (kind == NoiseTexture::Kind::marble) return {0.80f, 0.80f, 0.84f};
    return Rgb{kind == NoiseTexture::Kind::wrinkled ? 0.435f : 0.0f};
}

NoiseTexture noise_texture(NoiseTexture::Kind kind, ParameterList& p, const SourceLocation& where,
                           const Transform& texture_from_world) {
    constexpr int kMostOctaves = 64;  // the finest would be smaller than numbers can tell
    NoiseTexture t;
    t.kind = kind;
    t.texture_from_world = texture_from_world;
    if (kind == NoiseTexture::Kind::windy) return t;
    t.octaves = p.integer("octaves", t.octaves);
    if (t.octaves < 0 || t.octaves > kMostOctaves)
        throw Error(ErrorKind::scene, p.where("octaves", where),
                    "parameter \"octaves\" is " + std::to_string(t.octaves) + "; expected 0 to " +
                        std::to_string(kMostOctaves));
    t.omega = p.number("roughness", t.omega);
    if (kind != NoiseTexture::Kind::marble) return t;
    t.scale = p.number("scale", t.scale);
    t.variation = p.number("variation", t.variation);
    return t;
}

}  // namespace

void TextureBuilder::declare(std::string name, bool is_spectrum, Entity entity,
                             const CurrentTransform& texture_to_world) {
    const auto [it, is_new] = by_name_.try_emplace({is_spectrum, name}, declared_.size());
    if (!is_new)
        throw Error(ErrorKind::scene, entity.where,
                    "texture " + in_quotes(name) + " is already defined at " +
                        declared_[it->second].entity.where.to_string());
    declared_.push_back(
        {std::move(name), is_spectrum, std::move(entity), texture_to_world, -1, false});
}

void TextureBuilder::build_all() {
    for (Declared& d : declared_) build(d);
}

std::vector<std::string> TextureBuilder::names(bool is_spectrum) const {
    std::vector<std::string> all;
    for (const Declared& d : declared_)
        if (d.is_spectrum == is_spectrum) all.push_back(d.name);
    return all;
}

TextureId TextureBuilder::named(const Parameter& p, bool is_spectrum) {
    if (p.strings.size() != 1)
        throw Error(ErrorKind::scene, p.where,
                    "parameter " + in_quotes(p.name) + " expects one texture");
    return named(p.strings[0], p.name, p.where, is_spectrum);
}

TextureId TextureBuilder::named(const std::string& name, std::string_view parameter,
                                const SourceLocation& where, bool is_spectrum) {
    const auto it = by_name_.find({is_spectrum, name});
    if (it != by_name_.end()) return build(declared_[it->second]);
    const std::string kind = is_spectrum ? "spectrum" : "float";
    std::string text = "parameter " + in_quotes(parameter) + " names the " + kind + " texture " +
                       in_quotes(name) + ", which is not defined";
    if (by_name_.contains({!is_spectrum, name}))
        text += "; the texture of this name is of type " +
                std::string(is_spectrum ? "float" : "spectrum");
    throw Error(ErrorKind::scene, where, text + did_you_mean(name, names(is_spectrum)));
}

TextureId TextureBuilder::constant(Rgb value, bool is_spectrum) {
    const auto [it, is_new] =
        constants_.try_emplace({is_spectrum, value.r, value.g, value.b},
                               static_cast<TextureId>(context_.scene.textures.size()));
    if (is_new) context_.scene.textures.push_back({{}, is_spectrum, ConstantTexture{value}, {}});
    return it->second;
}

TextureId TextureBuilder::spectrum_or_none(ParameterList& list, std::string_view name,
                                           bool is_reflectance) {
    const Parameter* p = list.find(name, {ParameterType::texture, ParameterType::rgb,
                                          ParameterType::spectrum, ParameterType::blackbody});
    if (!p) return -1;
    if (p->type == ParameterType::texture) return named(*p, true);
    Rgb c = factor_colour(*p, context_);
    if (is_reflectance && max_component(c) > 1) {
        // A warning is due to given numbers alone: saturated spectra, and colours of other spaces,
        // among them white by rounding, lie beyond Rec.709 without anybody's fault.
        if (p->type == ParameterType::rgb &&
            std::ranges::any_of(p->numbers, [](float v) { return v > 1; }))
            context_.log.add(p->where, "parameter " + in_quotes(p->name) + " is above 1; cut to 1");
        c = {std::min(c.r, 1.0f), std::min(c.g, 1.0f), std::min(c.b, 1.0f)};
    }
    return constant(c, true);
}

TextureId TextureBuilder::reflectance_or_none(ParameterList& p, std::string_view name) {
    return spectrum_or_none(p, name, true);
}

TextureId TextureBuilder::reflectance(ParameterList& p, std::string_view name, Rgb otherwise) {
    const TextureId id = spectrum_or_none(p, name, true);
    return id >= 0 ? id : constant(otherwise, true);
}

TextureId TextureBuilder::unbounded(ParameterList& p, std::string_view name, Rgb otherwise) {
    const TextureId id = spectrum_or_none(p, name, false);
    return id >= 0 ? id : constant(otherwise, true);
}

TextureId TextureBuilder::grey_of(const Parameter& p) {
    if (p.type == ParameterType::texture) return named(p, false);
    if (p.numbers.size() != 1)
        throw Error(ErrorKind::scene, p.where,
                    "parameter " + in_quotes(p.name) + " expects one value");
    return constant(Rgb{p.numbers[0]}, false);
}

TextureId TextureBuilder::grey_or_none(ParameterList& list, std::string_view name) {
    const Parameter* p = list.find(name, {ParameterType::texture, ParameterType::floats});
    return p ? grey_of(*p) : -1;
}

TextureId TextureBuilder::grey(ParameterList& p, std::string_view name, float otherwise) {
    const TextureId id = grey_or_none(p, name);
    return id >= 0 ? id : constant(Rgb{otherwise}, false);
}

TextureId TextureBuilder::roughness_or_none(ParameterList& list, std::string_view name) {
    const TextureId id = grey_or_none(list, name);
    const Parameter* p = list.find(name, {ParameterType::texture, ParameterType::floats});
    if (!p || p->type == ParameterType::texture || !(p->numbers[0] < 0)) return id;
    context_.log.add(p->where, "parameter " + in_quotes(p->name) + " is below 0; cut to 0");
    return constant(Rgb{0}, false);
}

TextureId TextureBuilder::roughness(ParameterList& p, std::string_view name, float otherwise) {
    const TextureId id = roughness_or_none(p, name);
    return id >= 0 ? id : constant(Rgb{otherwise}, false);
}

TextureId TextureBuilder::part(Declared& d, std::string_view name, float otherwise) {
    return d.is_spectrum ? unbounded(d.entity.parameters, name, Rgb{otherwise})
                         : grey(d.entity.parameters, name, otherwise);
}

Rgb TextureBuilder::corner(Declared& d, std::string_view name, float otherwise) {
    ParameterList& p = d.entity.parameters;
    if (!d.is_spectrum) return Rgb{p.number(name, otherwise)};
    const Parameter* colour =
        p.find(name, {ParameterType::rgb, ParameterType::spectrum, ParameterType::blackbody});
    return colour ? factor_colour(*colour, context_) : Rgb{otherwise};
}

TextureId TextureBuilder::add(Declared& d, decltype(TextureDescription::value) value) {
    const auto id = static_cast<TextureId>(context_.scene.textures.size());
    context_.scene.textures.push_back({d.name, d.is_spectrum, std::move(value), d.entity.where});
    return id;
}

CheckerboardTexture TextureBuilder::checkerboard(Declared& d) {
    ParameterList& p = d.entity.parameters;
    CheckerboardTexture t;
    t.dimension = p.integer("dimension", 2);
    if (t.dimension != 2 && t.dimension != 3)
        throw Error(ErrorKind::scene, p.where("dimension", d.entity.where),
                    "parameter \"dimension\" of a checkerboard must be 2 or 3");
    if (t.dimension == 2)
        t.mapping = texture_mapping(p, d.entity.where, d.texture_to_world);
    else
        t.texture_from_world = d.texture_to_world.get(d.entity.where).inverse();
    t.tex1 = part(d, "tex1", 1);
    t.tex2 = part(d, "tex2", 0);
    return t;
}

MixTexture TextureBuilder::direction_mix(Declared& d) {
    ParameterList& p = d.entity.parameters;
    const Vec3 direction =
        d.texture_to_world.get(d.entity.where).vector(p.triple("dir", {0, 1, 0}));
    if (!(length(direction) > 0))
        throw Error(ErrorKind::scene, p.where("dir", d.entity.where),
                    "parameter \"dir\" must not be zero");
    MixTexture t;
    t.tex1 = part(d, "tex1", 0);
    t.tex2 = part(d, "tex2", 1);
    t.amount = static_cast<TextureId>(context_.scene.textures.size());
    context_.scene.textures.push_back(
        {{}, false, AsideTexture{normalize(direction)}, d.entity.where});
    return t;
}

FacingTexture TextureBuilder::facing(Declared& d) {
    ParameterList& p = d.entity.parameters;
    const SourceLocation where = p.where("textures", d.entity.where);
    const std::vector<std::string> parts = p.texts("textures");
    if (parts.empty())
        throw Error(ErrorKind::scene, where,
                    "a texture \"facing\" expects the names of textures in \"string textures\"");
    FacingTexture t;
    t.cosines = p.numbers("cosines");
    if (t.cosines.empty())
        for (size_t i = 0; i < parts.size(); ++i)
            t.cosines.push_back(float(i) / std::max(1.0f, float(parts.size() - 1)));
    const bool increase = std::ranges::is_sorted(t.cosines, std::ranges::less_equal{}) &&
                          std::ranges::all_of(t.cosines, [](float c) { return c >= -1 && c <= 1; });
    if (!increase || t.cosines.size() != parts.size())
        d.entity.refuse(
            "cosines",
            "parameter \"cosines\" of a texture \"facing\" must have a number for each of "
            "its " +
                std::to_string(parts.size()) +
                " textures, from -1 to 1, each above the one before");
    for (const std::string& name : parts)
        t.textures.push_back(named(name, "textures", where, d.is_spectrum));
    return t;
}

TextureId TextureBuilder::build(Declared& d) {
    if (d.id >= 0) return d.id;
    if (d.in_progress)
        throw Error(ErrorKind::scene, d.entity.where,
                    "texture " + in_quotes(d.name) + " refers to itself");
    if (++depth_ > kDeepestChain)
        throw Error(ErrorKind::scene, d.entity.where,
                    "textures refer to textures in too long a chain");
    d.in_progress = true;
    context_.log.set_order(d.entity.directive);
    ParameterList& p = d.entity.parameters;
    const std::string& type = d.entity.type;
    if (type == "constant") {
        if (d.is_spectrum)
            p.find("value",
                   {ParameterType::rgb, ParameterType::spectrum, ParameterType::blackbody});
        d.id = add(d, context_.scene.textures[static_cast<size_t>(part(d, "value", 1))].value);
    } else if (type == "imagemap") {
        d.id = add(d, image_texture(p, d.entity.where, d.texture_to_world, context_));
    } else if (type == "checkerboard") {
        d.id = add(d, checkerboard(d));
    } else if (type == "scale") {
        ScaleTexture t;
        t.tex = part(d, "tex", 1);
        t.scale = grey(p, "scale", 1);
        d.id = add(d, t);
    } else if (type == "mix") {
        MixTexture t;
        t.tex1 = part(d, "tex1", 0);
        t.tex2 = part(d, "tex2", 1);
        t.amount = grey(p, "amount", 0.5f);
        d.id = add(d, t);
    } else if (type == "directionmix") {
        d.id = add(d, direction_mix(d));
    } else if (type == "facing") {
        d.id = add(d, facing(d));
    } else if (type == "dots") {
        DotsTexture t;
        t.mapping = texture_mapping(p, d.entity.where, d.texture_to_world);
        // pbrt-v4 shows "inside" around the dots, "outside" in them: files were made to look so
        t.outside = part(d, "inside", 1);
        t.inside = part(d, "outside", 0);
        d.id = add(d, t);
    } else if (type == "bilerp") {
        BilerpTexture t;
        t.mapping = texture_mapping(p, d.entity.where, d.texture_to_world);
        t.v00 = corner(d, "v00", 0);
        t.v01 = corner(d, "v01", 1);
        t.v10 = corner(d, "v10", 0);
        t.v11 = corner(d, "v11", 1);
        d.id = add(d, t);
    } else if (const auto kind = noise_kind(type, d.is_spectrum)) {
        d.id = add(d, noise_texture(*kind, p, d.entity.where,
                                    d.texture_to_world.get(d.entity.where).inverse()));
    } else {
        d.id = stand_in(d);
    }
    context_.log.set_order(d.entity.directive);
    p.warn_unused(context_.log, "texture type " + in_quotes(type));
    d.in_progress = false;
    --depth_;
    return d.id;
}

/// A constant in place of a texture that pbrt has and covtrace doesn't render.
TextureId TextureBuilder::stand_in(Declared& d) {
    ParameterList& p = d.entity.parameters;
    const std::string& type = d.entity.type;
    if (type != "ptex") {
        std::vector<std::string> known{"constant", "imagemap", "checkerboard", "scale",
                                       "mix",      "dots",     "directionmix", "bilerp",
                                       "facing",   "ptex"};
        if (d.is_spectrum) {
            known.push_back("marble");
        } else {
            known.insert(known.end(), {"fbm", "wrinkled", "windy"});
        }
        throw unknown_type_error(d.entity.where,
                                 std::string(d.is_spectrum ? "spectrum" : "float") + " texture",
                                 type, known);
    }
    context_.log.set_order(d.entity.directive);
    context_.log.add(d.entity.where, "textures of type " + in_quotes(type) +
                                         " are not supported; a constant takes their place");
    p.ignore_all();
    return add(d, ConstantTexture{Rgb{0.5f}});
}

Rgb TextureBuilder::mean(TextureId id) {
    // Means are computed in the order of the textures, whose parts come before them, each once:
    // textures of two textures of two textures would take for ever otherwise.
    while (means_.size() <= static_cast<size_t>(id)) means_.push_back(mean_of_parts(means_.size()));
    return means_[static_cast<size_t>(id)];
}

Rgb TextureBuilder::mean_of_parts(size_t texture) const {
    const auto mean = [this](TextureId part) { return means_[static_cast<size_t>(part)]; };
    const auto& value = context_.scene.textures[texture].value;
    if (const auto* t = std::get_if<ConstantTexture>(&value)) return t->value;
    if (const auto* t = std::get_if<CheckerboardTexture>(&value))
        return mean_of(mean(t->tex1), mean(t->tex2));
    if (const auto* t = std::get_if<ScaleTexture>(&value)) return mean(t->tex) * mean(t->scale);
    if (const auto* t = std::get_if<MixTexture>(&value))
        return lerp(mean(t->amount).r, mean(t->tex1), mean(t->tex2));
    if (std::holds_alternative<AsideTexture>(value)) return Rgb{0.5f};  // over all directions
    if (const auto* t = std::get_if<FacingTexture>(&value)) {
        Rgb sum;
        for (TextureId part : t->textures) sum += mean(part) / float(t->textures.size());
        return sum;
    }
    if (const auto* t = std::get_if<DotsTexture>(&value)) {
        constexpr float kDots = 0.151f;  // measured: four cells in ten have one
        return lerp(kDots, mean(t->outside), mean(t->inside));
    }
    if (const auto* t = std::get_if<BilerpTexture>(&value))
        return mean_of(mean_of(t->v00, t->v01), mean_of(t->v10, t->v11));
    if (const auto* t = std::get_if<NoiseTexture>(&value)) return mean_of_noise(t->kind);
    return Rgb{0.5f * std::get<ImageTexture>(value).scale};
}

}  // namespace covtrace
