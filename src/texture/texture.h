/// Textures: values over a surface.
#pragma once

#include <array>
#include <limits>
#include <memory>

#include "geometry/hit.h"
#include "scene/scene_description.h"

namespace covtrace {

/// The ellipse that a pixel covers of a surface around a place: how far (u, v) and the world
/// position move along each of its two axes. All zero: the texture is read without a filter.
struct PointFootprint {
    std::array<Vec2, 2> duv{};
    std::array<Vec3, 2> dp{};
    bool is_point() const { return dp[0] == Vec3{} && dp[1] == Vec3{}; }
};
/// The footprint on a surface that is seen along the unit direction `w` (to or from the eye) by a
/// pixel that is `width` wide there.
PointFootprint footprint_on(const SurfaceHit& hit, Vec3 w, float width);

/// A place on a surface where a texture is looked up.
struct TexturePoint {
    Vec2 uv;
    Vec3 position;  ///< world space
    PointFootprint footprint = {};
    Vec3 normal = {};  ///< unit, of the geometry; zero where it isn't known
    VertexPlace vertices = {};
    /// Cosine between the interpolated normal and the direction that the place is seen from,
    /// negative behind the surface.
    float facing = kSeenFromNowhere;
};

struct TextureGraph;

/// No limit: textures take as much memory as their files ask for.
inline constexpr size_t kNoTextureLimit = std::numeric_limits<size_t>::max();

/// All textures of a scene, images loaded once per file, encoding and wrap mode. Thread-safe once
/// constructed.
///
/// Values follow pbrt-v4: images are looked up at (s, 1 - t), so that t = 0 is their last row; a
/// float texture of a colour image is the mean of R, G and B, or alpha where the image has one that
/// isn't 1 everywhere. Images are read from mip levels by the footprint and the filter that the
/// file names (TextureImage::color); checkerboards aren't filtered.
class TextureStore {
  public:
    /// Loads every image. Missing or broken files throw Error(scene) with the place in the scene
    /// file; textures nested a thousand deep or more, or of more than 10000
    /// lookups each, throw Error(limit).
    ///
    /// `most_bytes` limits what the images hold in memory together: where they need more, the
    /// largest levels are read from a temporary file, page by page, with a warning. Values don't
    /// depend on it. Throws Error(io) where that file can't be written, and later on where it can't
    /// be read.
    explicit TextureStore(const SceneDescription& scene, size_t most_bytes = kNoTextureLimit);
    ~TextureStore();
    TextureStore(const TextureStore&) = delete;
    TextureStore& operator=(const TextureStore&) = delete;

    Rgb eval(TextureId id, const TexturePoint& at) const;
    /// The red channel of a texture; for float textures, where all channels are equal.
    float eval_float(TextureId id, const TexturePoint& at) const;
    bool is_constant(TextureId id) const;
    /// Whether any texture hangs on the angle of sight.
    bool has_facing() const;
    /// Mean of the texture over (u, v) in [0, 1]^2: of an image's texels, of other textures at 64 x
    /// 64 points.
    Rgb mean(TextureId id) const;

    /// The nodes and images that the textures are made of, for those who analyse them.
    const TextureGraph& graph() const;
    /// Bytes held in memory by images and their pages.
    size_t memory() const;
    /// Warnings of loading: images are read from a temporary file, or a colour space is not known.
    const Warnings& warnings() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace covtrace
