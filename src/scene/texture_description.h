/// The textures of a scene as plain data. Float textures are grey: r = g = b. The conventions are
/// those of scene_description.h.
#pragma once

#include <compare>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "core/error.h"
#include "core/transform.h"
#include "core/vec.h"

namespace covtrace {

using TextureId = int;  ///< index into SceneDescription::textures

/// The map from (u, v) of the surface to (s, t) of the texture.
struct TextureMapping {
    enum class Kind { uv, spherical, cylindrical, planar };
    Kind kind = Kind::uv;
    float scale_u = 1, scale_v = 1, delta_u = 0, delta_v = 0;
    float u_per_v = 0, v_per_u = 0;  ///< uv only: how s changes with v, and t with u (a rotation)
    int uv_set = -1;  ///< uv only: index into TriangleMesh::more_uvs; -1: the surface's (u, v)
    Vec3 v1{1, 0, 0}, v2{0, 1, 0};  ///< planar only: (s, t) = (v1.p, v2.p) + delta at p
    Transform texture_from_world;   ///< all but uv
};

struct ConstantTexture {
    Rgb value{1};
};
struct ImageTexture {
    enum class Encoding { srgb, linear, gamma };
    enum class Wrap { repeat, black, clamp, octahedral_sphere, mirror };
    /// How the image goes on beyond its borders, in s and in t. The octahedral sphere is both ways
    /// or none.
    struct Wraps {
        Wrap s = Wrap::repeat, t = Wrap::repeat;
        Wraps() = default;
        Wraps(Wrap both) : s(both), t(both) {}
        Wraps(Wrap in_s, Wrap in_t) : s(in_s), t(in_t) {}
        friend auto operator<=>(const Wraps&, const Wraps&) = default;
    };
    enum class Filter { point, bilinear, trilinear, ewa };
    /// Channel that a float texture reads. Automatic: alpha where there is one, else the mean of R,
    /// G, B.
    enum class Channel { automatic, red, green, blue, alpha };
    std::filesystem::path file;
    /// The encoded image, where it is embedded in the scene; `file` is then its name in messages.
    std::shared_ptr<const std::string> content;
    /// Encoding of the values; empty: sRGB for integer files; float files are always linear.
    std::optional<Encoding> encoding;
    float gamma = 1;
    Wraps wrap;
    Filter filter = Filter::bilinear;
    Channel channel = Channel::automatic;  ///< float textures only
    std::optional<float> cutoff;           ///< float textures: 1 from there on, 0 below
    float max_anisotropy = 8;  ///< ewa: how much longer than wide a footprint may be, >= 1
    float scale = 1;
    bool invert = false;
    bool is_colour = true;  ///< spectrum textures: colours, not directions as in a normal map
    TextureMapping mapping;
};
struct CheckerboardTexture {
    int dimension = 2;  ///< 2: over (s, t); 3: over points in texture space
    TextureMapping mapping;
    Transform texture_from_world;
    TextureId tex1 = -1, tex2 = -1;  ///< tex1 on the squares with an even sum of coordinates
};
struct ScaleTexture {
    TextureId tex = -1, scale = -1;
};
struct MixTexture {
    TextureId tex1 = -1, tex2 = -1, amount = -1;  ///< (1 - amount) tex1 + amount tex2
};
/// A value that is 1 - |n.direction| with the surface's unit normal n: 0 where the surface faces
/// along the direction or against it, 1 where it stands edge-on. The amount of pbrt's
/// "directionmix".
struct AsideTexture {
    Vec3 direction;  ///< unit, world space
};
/// Textures by the angle of sight: linear over the cosine between the direction that the surface is
/// seen from and its interpolated normal, which no map has turned; constant beyond the first and
/// the last cosine. From behind the surface the cosine is negative, or the same as in front where
/// all that are given are positive. Where a place is not seen from anywhere, the mean over all
/// directions.
struct FacingTexture {
    std::vector<TextureId> textures;  ///< at least one
    std::vector<float> cosines;       ///< one for each, in [-1, 1], strictly increasing
};
/// Round dots of one texture on another, in randomly chosen unit cells of (s, t).
struct DotsTexture {
    TextureMapping mapping;
    TextureId inside = -1, outside = -1;
};
/// Values at the corners (s, t) of the unit square (v01 at s = 0, t = 1), bilinear between and
/// beyond them.
struct BilerpTexture {
    TextureMapping mapping;
    Rgb v00, v01, v10, v11;
};
/// The colours of a mesh's vertices, or their alpha, linear over each triangle; 1 on other shapes.
struct VertexColourTexture {
    bool is_alpha = false;
};
/// A value that is 1 where `tex` is at least `cutoff`, 0 elsewhere.
struct CutoffTexture {
    TextureId tex = -1;
    float cutoff = 0.5f;
};
/// Solid noise in texture space.
struct NoiseTexture {
    enum class Kind { fbm, wrinkled, windy, marble };
    Kind kind = Kind::fbm;
    Transform texture_from_world;
    int octaves = 8;
    float omega = 0.5f;                 ///< pbrt's "roughness"
    float scale = 1, variation = 0.2f;  ///< marble only
};
struct TextureDescription {
    std::string name;  ///< empty for values given inline
    bool is_spectrum = true;
    std::variant<ConstantTexture, ImageTexture, CheckerboardTexture, ScaleTexture, MixTexture,
                 AsideTexture, DotsTexture, BilerpTexture, NoiseTexture, VertexColourTexture,
                 CutoffTexture, FacingTexture>
        value;
    SourceLocation where;
};

}  // namespace covtrace
