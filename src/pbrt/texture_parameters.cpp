#include "pbrt/texture_parameters.h"

#include <array>
#include <charconv>
#include <cmath>

#include "scene/names.h"

namespace covtrace {

namespace {

/// The value of a string parameter that must be one of a few.
template <typename Value, size_t N>
Value choice(ParameterList& p, const SourceLocation& where, const std::string& name,
             const std::array<std::pair<const char*, Value>, N>& known, Value otherwise) {
    const std::string text = p.text(name);
    if (text.empty()) return otherwise;
    std::vector<std::string> names;
    for (const auto& [n, value] : known) {
        if (text == n) return value;
        names.emplace_back(n);
    }
    throw Error(ErrorKind::scene, p.where(name, where), unknown_name(name, text, names));
}

void set_encoding(ImageTexture& t, ParameterList& p, const SourceLocation& where) {
    using Encoding = ImageTexture::Encoding;
    const std::string text = p.text("encoding");
    if (text.empty()) {
        // PNG files of any depth are decoded as sRGB, as in pbrt.
        std::string extension = t.file.extension().string();
        if (extension == ".png" || extension == ".PNG") t.encoding = Encoding::srgb;
    } else if (text == "sRGB") {
        t.encoding = Encoding::srgb;
    } else if (text == "linear") {
        t.encoding = Encoding::linear;
    } else {
        constexpr std::string_view prefix = "gamma ";
        const char* end = text.data() + text.size();
        const bool is_gamma = text.starts_with(prefix);
        const char* begin = is_gamma ? text.data() + prefix.size() : end;
        const auto [rest, error] = std::from_chars(begin, end, t.gamma);
        if (error != std::errc{} || rest != end || !(t.gamma > 0) || !std::isfinite(t.gamma))
            throw Error(ErrorKind::scene, p.where("encoding", where),
                        "unknown encoding " + in_quotes(text) +
                            "; expected sRGB, linear, or gamma and a number");
        t.encoding = Encoding::gamma;
    }
}

}  // namespace

TextureMapping texture_mapping(ParameterList& p, const SourceLocation& where,
                               const CurrentTransform& texture_to_world) {
    using Kind = TextureMapping::Kind;
    TextureMapping m;
    m.kind = choice<Kind, 4>(p, where, "mapping",
                             {{{"uv", Kind::uv},
                               {"spherical", Kind::spherical},
                               {"cylindrical", Kind::cylindrical},
                               {"planar", Kind::planar}}},
                             Kind::uv);
    if (m.kind != Kind::uv) m.texture_from_world = texture_to_world.get(where).inverse();
    if (m.kind == Kind::uv) {
        m.scale_u = p.number("uscale", 1);
        m.scale_v = p.number("vscale", 1);
    }
    if (m.kind == Kind::planar) {
        m.v1 = p.triple("v1", m.v1);
        m.v2 = p.triple("v2", m.v2);
    }
    if (m.kind == Kind::uv || m.kind == Kind::planar) {
        m.delta_u = p.number("udelta", 0);
        m.delta_v = p.number("vdelta", 0);
    }
    return m;
}

ImageTexture image_texture(ParameterList& p, const SourceLocation& where,
                           const CurrentTransform& texture_to_world, BuildContext& context) {
    using Wrap = ImageTexture::Wrap;
    using Filter = ImageTexture::Filter;
    ImageTexture t;
    const std::string file = p.text("filename");
    if (file.empty())
        throw Error(ErrorKind::scene, where,
                    "an imagemap has no image; expected \"string filename\"");
    t.file = context.files.find(file, p.where("filename", where));
    t.mapping = texture_mapping(p, where, texture_to_world);
    t.wrap = choice<Wrap, 4>(p, where, "wrap",
                             {{{"repeat", Wrap::repeat},
                               {"black", Wrap::black},
                               {"clamp", Wrap::clamp},
                               {"octahedralsphere", Wrap::octahedral_sphere}}},
                             Wrap::repeat);
    t.filter = choice<Filter, 5>(p, where, "filter",
                                 {{{"point", Filter::point},
                                   {"bilinear", Filter::bilinear},
                                   {"trilinear", Filter::trilinear},
                                   {"ewa", Filter::ewa},
                                   {"EWA", Filter::ewa}}},
                                 t.filter);
    t.scale = p.number("scale", 1);
    t.invert = p.flag("invert", false);
    set_encoding(t, p, where);
    // The limit bounds the cost: a lookup takes about as many texels as the anisotropy.
    constexpr float kMostAnisotropy = 256;
    t.max_anisotropy = std::min(std::max(1.0f, p.number("maxanisotropy", 8)), kMostAnisotropy);
    return t;
}

}  // namespace covtrace
