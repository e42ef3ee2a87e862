#include "gltf/read_gltf.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <sstream>

#include "gltf/animation.h"
#include "gltf/camera.h"
#include "gltf/choice.h"
#include "gltf/deformed_nodes.h"
#include "gltf/document.h"
#include "gltf/extensions.h"
#include "gltf/geometry.h"
#include "gltf/lights.h"
#include "gltf/marks.h"
#include "gltf/materials.h"
#include "gltf/nodes.h"
#include "scene/inside_out.h"
#include "scene/with_limits.h"

namespace covtrace {

namespace gltf {
namespace {

/// Turns placed nodes into shapes, objects and instances of the scene.
class SceneAssembler {
  public:
    SceneAssembler(const Document& document, const PlacedNodes& placed,
                   const Animations& animations, const std::optional<size_t>& variant,
                   std::array<float, 2> shutter, SceneDescription& scene, WarningLog& log)
        : document_(document),
          placed_(placed),
          variant_(variant),
          scene_(scene),
          log_(log),
          geometry_(document, log, mark_radii(document, placed)),
          deformed_(document, log, geometry_, placed, animations, shutter),
          materials_(document, scene, log) {}

    void add() {
        std::map<int, int> uses;
        for (const PlacedNode& n : placed_.nodes)
            if (node(n).mesh >= 0) ++uses[node(n).mesh];
        for (const PlacedNode& n : placed_.nodes) {
            warn_of_left_out(document_, node(n).extensions,
                             element("nodes", static_cast<size_t>(n.node)), log_);
            if (node(n).mesh >= 0) add_mesh(n, uses[node(n).mesh] > 1);
            add_light(document_, n, scene_, log_);
        }
    }

    const Bounds3& bounds() const { return bounds_; }
    bool has_lamps() const { return has_lamps_ || !scene_.lights.empty(); }

  private:
    const tinygltf::Node& node(const PlacedNode& placed) const {
        return document_.model.nodes[static_cast<size_t>(placed.node)];
    }

    void add_mesh(const PlacedNode& placed, bool is_shared) {
        const std::string place = element("nodes", static_cast<size_t>(placed.node));
        at(document_, document_.model.meshes, node(placed).mesh, "meshes", place + ".mesh");
        if (deformed_.deforms(placed)) return add_deformed(placed);
        const int object = is_shared ? object_of(node(placed).mesh) : -1;
        if (object >= 0)
            scene_.instances.push_back({object, placed.transform, document_.place(place)});
        for (const Part& part : parts_of(node(placed).mesh)) {
            grow(part.bounds, placed.transform);
            // Emitters are no parts of objects, because each is a light of its own.
            if (object >= 0 && !part.emission) continue;
            add_shape(part, part.shape.geometry, placed.transform);
        }
    }

    /// Adds a deformed mesh, which each node has for itself: its shape is the node's.
    void add_deformed(const PlacedNode& placed) {
        for (const Part& part : parts_of(node(placed).mesh))
            for (MovedMesh& moved : deformed_.meshes(placed, part.primitive, part.layout)) {
                Bounds3 bounds;
                for (const Vec3& p : moved.mesh->positions) bounds.extend(p);
                grow(bounds, moved.to_world);
                add_shape(part, std::move(moved.mesh), moved.to_world);
            }
    }

    /// The object that holds the parts of a mesh which don't emit; -1 where there are none.
    int object_of(int mesh) {
        const auto [entry, is_new] = objects_.try_emplace(mesh, -1);
        if (!is_new) return entry->second;
        ObjectDescription object;
        object.name = document_.model.meshes[static_cast<size_t>(mesh)].name;
        for (const Part& part : parts_of(mesh))
            if (!part.emission) object.shapes.push_back(part.shape);
        if (object.shapes.empty()) return -1;
        scene_.objects.push_back(std::move(object));
        return entry->second = static_cast<int>(scene_.objects.size() - 1);
    }

    /// A primitive in the space of its mesh, its emission, and its bounds there.
    struct Part {
        ShapeDescription shape;
        std::optional<AreaLightDescription> emission;
        bool is_strong_light = false;
        Bounds3 bounds;
        size_t primitive = 0;  ///< index into the mesh's primitives
        VertexLayout layout;
    };

    /// The visible parts of a mesh, read once however many nodes place it.
    const std::vector<Part>& parts_of(int mesh) {
        const auto [entry, is_new] = parts_.try_emplace(mesh);
        if (!is_new) return entry->second;
        const size_t count = document_.model.meshes[static_cast<size_t>(mesh)].primitives.size();
        for (size_t i = 0; i < count; ++i)
            if (auto part = part_of(mesh, i)) entry->second.push_back(std::move(*part));
        return entry->second;
    }

    void add_shape(const Part& part, decltype(ShapeDescription::geometry) geometry,
                   const AnimatedTransform& to_world) {
        ShapeDescription shape = part.shape;
        shape.geometry = std::move(geometry);
        shape.object_to_world = to_world;
        if (part.emission) {
            scene_.area_lights.push_back(*part.emission);
            shape.area_light = static_cast<int>(scene_.area_lights.size() - 1);
            has_lamps_ = has_lamps_ || part.is_strong_light;
        }
        scene_.shapes.push_back(std::move(shape));
    }

    std::optional<Part> part_of(int mesh, size_t index) {
        const std::string place =
            element("meshes", static_cast<size_t>(mesh)) + "." + element("primitives", index);
        const tinygltf::Primitive& primitive =
            document_.model.meshes[static_cast<size_t>(mesh)].primitives[index];
        warn_of_left_out(document_, primitive.extensions, place, log_);
        // By the specification points and lines without normals are not lit.
        const bool is_unlit = has_marks(primitive) && !primitive.attributes.contains("NORMAL");
        if (has_marks(primitive)) log_.add(document_.place(place), told_of_marks(primitive));
        const int material = material_of(document_, primitive, variant_, place);
        const auto surface_of = [&](bool unlit) -> const Surface& {
            return materials_.surface(material, geometry_.colours(mesh, index), unlit, place);
        };
        const Surface* read = &surface_of(is_unlit);
        if (!read->is_visible) return std::nullopt;
        auto triangles = geometry_.mesh(mesh, index, read->layout);
        if (!triangles) return std::nullopt;
        if (!is_unlit && materials_.may_outline(material) && is_inside_out(*triangles)) {
            read = &surface_of(true);
            log_.add(document_.place(place),
                     "a dark shell that is inside out is an outline: only the camera sees it, and "
                     "light passes it");
        }
        const Surface& surface = *read;
        Part part;
        for (const Vec3& p : triangles->positions) part.bounds.extend(p);
        part.shape.geometry = std::move(triangles);
        part.shape.material = surface.material;
        part.shape.alpha = surface.alpha;
        part.shape.inside = surface.inside;
        part.shape.is_seen_from_back = surface.is_seen_from_back;
        part.shape.where = document_.place(place);
        part.emission = surface.emission;
        part.is_strong_light = surface.is_strong_light;
        part.primitive = index;
        part.layout = surface.layout;
        return part;
    }

    void grow(const Bounds3& local, const AnimatedTransform& to_world) {
        for (int corner = 0; corner < 8; ++corner)
            bounds_.extend(to_world.start().point({corner & 1 ? local.hi.x : local.lo.x,
                                                   corner & 2 ? local.hi.y : local.lo.y,
                                                   corner & 4 ? local.hi.z : local.lo.z}));
    }

    const Document& document_;
    const PlacedNodes& placed_;
    const std::optional<size_t> variant_;
    SceneDescription& scene_;
    WarningLog& log_;
    GeometryReader geometry_;
    DeformedNodes deformed_;
    MaterialReader materials_;
    std::map<int, std::vector<Part>> parts_;
    std::map<int, int> objects_;
    Bounds3 bounds_;
    bool has_lamps_ = false;
};

/// Shapes and lights of a whole animation, by which each of its frames is looked at, so that
/// nothing jumps from one to the next.
struct Sweep {
    Bounds3 bounds;                                     ///< SceneDescription::swept
    std::vector<std::vector<LightDescription>> lights;  ///< by moment
    bool has_lamps = false;                             ///< at any moment
};

/// Leaves the document as it is at the end of the animations.
Sweep sweep(Document& document, const Choice& choice, const Animations& animations) {
    constexpr int kMoments = 9;
    constexpr float kExposure = 0.001f;  // seconds
    const std::array<float, 2> span = animations.span();
    Sweep swept;
    for (int i = 0; i < kMoments; ++i) {
        const float time = span[0] + (span[1] - span[0]) * float(i) / float(kMoments - 1);
        const std::array<float, 2> shutter{time, time + kExposure};
        SceneDescription moment;
        WarningLog unheard;  // the frame itself tells what is wrong with the file
        animations.properties().apply(double(time), document, unheard);
        const PlacedNodes placed =
            place_nodes(document, choice.scene, animations, shutter, unheard);
        SceneAssembler assembler(document, placed, animations, choice.variant, shutter, moment,
                                 unheard);
        assembler.add();
        swept.bounds.extend(assembler.bounds());
        swept.has_lamps = swept.has_lamps || assembler.has_lamps();
        swept.lights.push_back(std::move(moment.lights));
    }
    return swept;
}

std::string at_rest(const std::array<float, 2>& span) {
    std::ostringstream text;
    text << "the scene is rendered at rest, at 0 seconds; it is animated from " << span[0] << " to "
         << span[1] << " seconds, of which a shutter from T0 to T1 seconds shows a part";
    return text.str();
}

SceneDescription read(Document document, const ReadOptions& options, WarningLog& log) {
    SceneDescription scene;
    scene.name = std::filesystem::path(document.name).stem().string();
    scene.up = Vec3{0, 1, 0};
    // Depth and samples are ours, as a format for interchange says nothing of quality: enough for
    // glass, and for a clean image.
    constexpr int kDepth = 12, kSamples = 64;
    scene.max_depth = kDepth;
    scene.samples_per_pixel = kSamples;

    const Choice choice = choose(document, options, scene, log);
    if (choice.scene >= 0) {
        const auto index = static_cast<size_t>(choice.scene);
        warn_of_left_out(document, document.model.scenes[index].extensions,
                         element("scenes", index), log);
    }
    const Animations animations(document, choice.animations, log);
    if (!animations.empty() && !options.shutter)
        log.add(document.place("animations"), at_rest(animations.span()));
    if (options.is_frame && animations.empty())
        log.add(document.place("animations"), "nothing is animated: all frames are alike");
    std::optional<Sweep> swept;
    if (options.is_frame && !animations.empty()) swept = sweep(document, choice, animations);
    const std::array<float, 2> shutter = options.shutter.value_or(std::array<float, 2>{0, 0});
    // Whatever moves beside nodes does not blur: the middle of the exposure stands for all of it.
    animations.properties().apply((double(shutter[0]) + double(shutter[1])) / 2, document, log);
    const PlacedNodes placed = place_nodes(document, choice.scene, animations, shutter, log);
    SceneAssembler assembler(document, placed, animations, choice.variant, shutter, scene, log);
    assembler.add();
    Bounds3 bounds = assembler.bounds();
    if (swept) bounds = scene.swept = swept->bounds;
    if (bounds.empty()) bounds = {Vec3{-1, -1, -1}, Vec3{1, 1, 1}};
    set_view(document, placed.nodes, bounds, options.camera, scene, log);
    if (options.shutter) {
        const auto [open, close] = *options.shutter;
        scene.camera.shutter_open = open;
        scene.camera.shutter_close = close;
        // The film's speed makes up for the time of exposure, by which images are scaled: here that
        // is to change the blur alone.
        scene.film.iso = 100 / (close - open);
    }
    std::vector<std::vector<LightDescription>> judged{scene.lights};
    if (swept) judged = std::move(swept->lights);
    scale_lights(document, bounds, judged, scene, log);
    const std::string stand_ins =
        "a grey sky and a key light from the upper left of the camera light it";
    if (!assembler.has_lamps() && !(swept && swept->has_lamps))
        scene.no_lights = {document.place(""),
                           "the scene has no lights (KHR_lights_punctual, or an emissive strength "
                           "above 1); " +
                               stand_ins};
    else if (scene.lights.empty() && !swept)
        scene.glow_alone = {document.place(""),
                            "the scene's only lights are surfaces that glow, which leave most of "
                            "what is seen dark; " +
                                stand_ins + ", too"};
    scene.warnings = log.take();
    scene.content_hash = document.content_hash;
    scene.files = {document.files.begin(), document.files.end()};
    return scene;
}

}  // namespace
}  // namespace gltf

bool is_gltf(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension == ".gltf" || extension == ".glb";
}

SceneDescription read_gltf(const std::filesystem::path& file, const ReadOptions& options) {
    return with_limits(file.string(), [&] {
        WarningLog log;
        return gltf::read(gltf::read_document(file, options.search_paths, log), options, log);
    });
}

SceneDescription read_gltf_bytes(const std::string& bytes, const std::string& name,
                                 const std::filesystem::path& folder, const ReadOptions& options) {
    return with_limits(name, [&] {
        WarningLog log;
        return gltf::read(gltf::parse_document(bytes, name, folder, options.search_paths, log),
                          options, log);
    });
}

}  // namespace covtrace
