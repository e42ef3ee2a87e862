/// A scene as plain data: the reader of a file fills it, the renderer builds from it. Everything is
/// checked when it gets here: indices are in range, numbers are finite, references resolved.
/// Lengths are in scene units, angles in degrees, colours linear Rec.709, `-1` means "none" for
/// every index.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/error.h"
#include "core/transform.h"
#include "core/vec.h"
#include "scene/lamp_description.h"
#include "scene/lens_description.h"
#include "scene/light_description.h"
#include "scene/material_description.h"
#include "scene/ray_kind.h"
#include "scene/texture_description.h"
#include "volume/density_grid.h"
#include "volume/emission_field.h"
#include "volume/glow.h"

namespace covtrace {

using MediumId = int;  ///< index into SceneDescription::media

// ---- media

struct MediumDescription {
    std::string name;
    Rgb sigma_a, sigma_s;  ///< per scene unit, scale applied
    Rgb emission;          ///< pbrt's Le: radiance of the absorbing part, scale applied
    float g = 0;           ///< mean cosine of the phase function, in (-1, 1)
    SourceLocation where;
    /// Factor of both coefficients, in world space; null: 1 everywhere.
    std::shared_ptr<const DensityGrid> density = {};
    /// Emission that varies, in the place of `emission`; its field is in world space. May be null.
    std::shared_ptr<const Glow> glow = {};
    /// Emission beside these that does not hang on the density, in world space. May be null.
    std::shared_ptr<const EmissionField> source = {};
    /// Whether the camera's rays, straight on, find the medium; else they pass as where it is not.
    bool is_seen = true;
};

// ---- shapes, in object space

struct VertexColour {
    Rgb value{1};
    float alpha = 1;
};
struct TriangleMesh {
    static constexpr float kLargestColourStep = 255;  ///< contrast of something beside black
    std::vector<Vec3> positions;
    std::vector<Vec3> normals;  ///< empty or one per position
    std::vector<Vec2> uvs;      ///< empty or one per position
    std::vector<std::array<uint32_t, 3>> triangles;
    /// Shading tangents in place of those of the uvs: empty or one per position; 0 for none.
    std::vector<Vec3> tangents = {};
    /// Signs, 1 or -1, that turn the y of normal maps about: empty, or one per triangle.
    std::vector<int8_t> map_signs = {};
    std::vector<std::vector<Vec2>> more_uvs = {};  ///< sets of coordinates, one per position each
    std::vector<VertexColour> colours = {};        ///< empty or one per position
    /// Contrasts of the colours across the side opposite each corner, in [0, kLargestColourStep];
    /// empty or one per triangle (find_colour_steps).
    std::vector<std::array<uint8_t, 3>> colour_steps = {};
};
/// Bilinear patches, each of four corners p00, p10, p01, p11.
struct BilinearMesh {
    std::vector<Vec3> positions;
    std::vector<Vec3> normals;
    std::vector<Vec2> uvs;
    std::vector<std::array<uint32_t, 4>> patches;
};
struct Sphere {
    float radius = 1, z_min = -1, z_max = 1, phi_max = 360;
};
struct Disk {
    float height = 0, radius = 1, inner_radius = 0, phi_max = 360;
};

/// Diffuse emission of a shape; `radiance` includes every scale of the file.
struct AreaLightDescription {
    Rgb radiance{1};
    std::optional<float> power;  ///< watts over the whole shape, in place of the radiance's size
    bool two_sided = false;
    TextureId image = -1;  ///< multiplies the radiance, over the shape's (u, v)
    SourceLocation where;
    /// Whether the shape is no surface but for its light: rays that meet it take up its light and
    /// go on, and it casts no shadow.
    bool lets_light_pass = false;
    /// A cone about the z axis of the shape's space that light stays within as a SpotLight's, or as
    /// a grid of slats leaves it (SpotCone::grid).
    struct Cone {
        float angle = 30, delta_angle = 5;
        bool is_grid = false;
        Vec2 stretch{1, 1};  ///< factors along x and y by which a cone is wider; not of grids
    };
    std::optional<Cone> cone = {};
    /// Whether places are lit by a sphere as by a disc of the same radius and radiance that faces
    /// them, which is less light than a sphere's where the distance is not much more.
    bool soft_falloff = false;
    /// An image over the directions that the light leaves in, as a GoniometricLight has one; it
    /// multiplies the radiance.
    std::optional<std::filesystem::path> goniometric = {};
};

/// Moves the vertices of a mesh along their normals, after its triangles have been split.
struct Displacement {
    TextureId height = -1;  ///< by how much, in object space
    float edge_length = 1;  ///< triangles are split until their edges are shorter, world units
};

struct ShapeDescription {
    /// Meshes are shared, so that a description can be copied cheaply.
    std::variant<std::shared_ptr<const TriangleMesh>, std::shared_ptr<const BilinearMesh>, Sphere,
                 Disk>
        geometry;
    AnimatedTransform object_to_world;
    bool reverse_orientation = false;
    MaterialId material = -1;
    int area_light = -1;  ///< index into SceneDescription::area_lights
    /// Number of the file's directive that made the shape: shapes with the same number share the
    /// power of their area light. -1: the shape has it alone.
    int directive = -1;
    /// Opacity, in [0, 1]. A constant 0 stands for a light that lights the scene but is not seen;
    /// shapes without light never have it.
    TextureId alpha = -1;
    MediumId inside = -1, outside = -1;
    SourceLocation where;
    std::optional<Displacement> displacement = {};  ///< of triangles with normals and uvs only
    /// Rays that the shape is there for; always `any`, and every one for interfaces.
    RayKinds visible_to = kEveryRay;
    /// Whether the camera's rays, straight on, end there as where there is nothing: the picture is
    /// black and clear. All other rays meet the shape as it is.
    bool is_holdout = false;
    /// Whether rays by which the camera sees, straight, in perfect mirrors and through clear glass,
    /// meet the shape's inside, too; else they pass it. All others meet both sides.
    bool is_seen_from_back = true;
    /// Sides of each of the tubes that the shape consists of, in the place of ribbons at which
    /// light is scattered once, from one side to the other: rays within them pass their walls where
    /// those are translucent. v runs around them from 0 to 1, all sides alike. 0: it is no such
    /// shape.
    int tube_sides = 0;
};

struct ObjectDescription {
    std::string name;
    std::vector<ShapeDescription> shapes;
};
struct InstanceDescription {
    int object = -1;  ///< index into SceneDescription::objects
    AnimatedTransform instance_to_world;
    SourceLocation where;
};

// ---- view

/// The aperture of a thin lens: a disc, or a regular polygon with its corners on the disc's rim.
struct ApertureBlades {
    int count = 0;       ///< corners, 3 or more; 0: a disc
    float rotation = 0;  ///< radians, from x to y of camera space; 0: the right edge is upright
    float ratio = 1;     ///< how many times narrower than high it is, for a disc of ratio 1
};

struct CameraDescription {
    enum class Kind { perspective, orthographic, spherical };
    /// The directions of a spherical camera over the film, top row first: the equal-area octahedral
    /// map, or polar angle by azimuth, where y is the pole; or those of a fisheye (Panorama).
    enum class Mapping { equal_area, equirectangular, equidistant, equisolid };
    Kind kind = Kind::perspective;
    AnimatedTransform camera_to_world;  ///< x right, y up, z forward in camera space
    /// Degrees: of the shorter axis, unless the screen window is given; of a fisheye's circle.
    float fov = 90;
    float frame_aspect_ratio = 0;                       ///< 0: from the resolution
    std::optional<std::array<float, 4>> screen_window;  ///< x0, x1, y0, y1
    /// Whether the window is stretched over the film; else it is widened to the film's aspect.
    bool window_fills_film = true;
    Mapping mapping = Mapping::equal_area;
    /// The part of the equirectangular map that is shown: its left, right, top and bottom, in
    /// fractions of the whole.
    std::array<float, 4> sphere_part{0, 1, 0, 1};
    /// Irradiance that a radiance of 1 gives in the middle of the film; pi (radius / distance)^2
    /// for real lenses.
    float film_irradiance = 1;
    float lens_radius = 0, focal_distance = 1e6f;
    ApertureBlades blades;  ///< of a thin lens
    /// A lens of several surfaces that rays are traced through. The numbers above are those of the
    /// thin lens that stands for it where its covariance is predicted: `lens_radius` is that of the
    /// entrance pupil, which its stop is opened for; `focal_distance` is measured from the film.
    std::shared_ptr<const LensDescription> lens = {};
    float shutter_open = 0, shutter_close = 1;
    MediumId medium = -1;  ///< around the lens
    SourceLocation where;
};

struct FilmDescription {
    /// Space of the layers that tell of the first surfaces, where the scene asks for them (pbrt's
    /// "gbuffer").
    enum class Surfaces { none, camera, world };
    int width = 1280, height = 720;
    static constexpr const char* kLargest = "at most 65536 pixels a side and 2^30 in all";
    bool is_too_large() const {
        return width > 65536 || height > 65536 || int64_t{width} * height > int64_t{1} << 30;
    }
    std::array<float, 4> crop_window{0, 1, 0, 1};    ///< x0, x1, y0, y1 as fractions
    std::optional<std::array<int, 4>> pixel_bounds;  ///< x0, x1, y0, y1 in pixels, end exclusive
    std::string filename;                            ///< empty: not given
    float iso = 100;
    /// Matrix from linear Rec.709 to linear Rec.709 as the sensor and its white balance show it.
    std::array<std::array<float, 3>, 3> sensor{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    /// Matrix from the colour that the sensor shows to its three values: XYZ before the white
    /// balance, or those of a camera.
    std::array<std::array<float, 3>, 3> sensor_values{{{0.41239080f, 0.35758434f, 0.18048079f},
                                                       {0.21263901f, 0.71516868f, 0.07219232f},
                                                       {0.01933082f, 0.11919478f, 0.95053215f}}};
    /// Largest of the sensor's values for a sample, which is dimmed to it as a whole.
    float max_component_value = kInfinity;
    Surfaces surfaces = Surfaces::none;
    SourceLocation where;
};

struct FilterDescription {
    enum class Kind { box, triangle, gaussian, mitchell, lanczos_sinc };
    Kind kind = Kind::gaussian;
    float x_radius = 1.5f, y_radius = 1.5f;
    float sigma = 0.5f;                ///< of Gaussian filters
    float b = 1.0f / 3, c = 1.0f / 3;  ///< of Mitchell's filter
    float tau = 3;                     ///< of sinc filters
};

struct SceneDescription {
    std::string name;  ///< the file's name without folder and extension
    CameraDescription camera;
    FilmDescription film;
    FilterDescription filter;
    int samples_per_pixel = 16;
    int max_depth = 5;
    bool renders_media = true;  ///< false: the integrator sees no media, as pbrt's "path"
    /// Whether sharp lobes beyond a path's first lobe that is not specular are widened, as with
    /// pbrt's "regularize".
    bool regularizes = false;
    /// Whether reflectances are those of spectra under the scene's light (IlluminantAdaptation);
    /// false: light and reflectance are multiplied channel by channel.
    bool adapts_colours = true;
    std::optional<Vec3> up;  ///< axis of the world that points up, where the format or user says
    std::vector<TextureDescription> textures;
    std::vector<MaterialDescription> materials;
    std::vector<MediumDescription> media;
    std::vector<AreaLightDescription> area_lights;
    std::vector<LightDescription> lights;
    std::vector<LampDescription>
        lamps;  ///< beside them, until the renderer has made lights of them
    std::vector<ShapeDescription> shapes;
    std::vector<ObjectDescription> objects;
    std::vector<InstanceDescription> instances;
    /// Warnings of the reader, in file order: features that covtrace replaces or ignores.
    Warnings warnings;
    /// Hash of all bytes read for the description: scene files and meshes.
    uint64_t content_hash = 0;
    /// Warnings of a file that has no camera, or no light: `complete` gives them out with its
    /// defaults. Empty where the file has one, or where another one took the place.
    std::optional<Warning> no_camera, no_lights;
    /// Whether its file has no light, and all light is from outside: that of stand-ins
    /// (`complete`), or an environment that took their place.
    bool is_lit_from_outside = false;
    /// The warning of a file whose only lamps are surfaces that glow, where its format has viewers
    /// light the rest: the renderer gives it out with the stand-ins for light where little of what
    /// is seen is reached by the glow. Empty where another light took their place.
    std::optional<Warning> glow_alone;
    /// Bounds of the shapes at some moments of a whole animation, in world space, where the scene
    /// is a frame of one: a camera and lights that the file lacks are placed by them, and stand
    /// still. Else empty.
    Bounds3 swept;
    /// Camera and environment in place of the file's, and lamps beside its own, as text for a
    /// render's identity; empty: its own, and none.
    std::string camera_override, environment_override, lamps_text;
    /// Choices among the file's cameras, scenes, animations and variants of materials, as text for
    /// a render's identity; empty: the reader's own.
    std::string camera_choice, gltf_scene_choice, animation_choice, variant_choice;
    /// All files that were read for the scene or that it names: scenes, meshes, spectra, lenses,
    /// buffers, images. Each once, by name.
    std::vector<std::filesystem::path> files;
};

}  // namespace covtrace
