#include "gltf/camera.h"

#include <algorithm>
#include <cmath>

#include "gltf/choice.h"
#include "gltf/units.h"
#include "scene/framing.h"

namespace covtrace::gltf {
namespace {

// Film resolution in pixels, as everywhere where a file gives none.
constexpr int kLongerSide = 1280;

/// Gives the film about 1280 pixels on its longer side.
void set_film(FilmDescription& film, double aspect) {
    aspect = std::clamp(aspect, 1e-2, 1e2);
    const auto shorter = [&](double a) { return std::max(1, int(std::lround(kLongerSide * a))); };
    film.width = aspect >= 1 ? kLongerSide : shorter(aspect);
    film.height = aspect >= 1 ? shorter(1 / aspect) : kLongerSide;
}

/// A camera's transform without scale and shear, which do not count for cameras (glTF 2.0, section
/// 3.10): the axis of view stays, "up" is made orthogonal to it. The transform stays as it is where
/// nothing is left of an axis.
Transform without_scale(const Transform& node) {
    const Vec3 given[] = {node.vector({1, 0, 0}), node.vector({0, 1, 0}), node.vector({0, 0, 1})};
    const Vec3 z = normalize(given[2]), x = normalize(cross(given[1], z)), y = cross(z, x);
    const Vec3 axes[] = {x, y, z};
    const auto distances = {length(x - given[0]), length(y - given[1]), length(z - given[2])};
    const float largest = std::max(distances);
    if (!std::isfinite(largest) || x == Vec3{} || z == Vec3{}) return node;
    if (largest < 1e-6f) return node;
    Matrix4 m = node.matrix();
    for (size_t row = 0; row < 3; ++row)
        for (size_t column = 0; column < 3; ++column)
            m.m[row][column] = double(axes[column][static_cast<int>(row)]);
    return Transform::from_matrix(m).value_or(node);
}

/// glTF's cameras look along -z, ours along +z; both have x to the right and y up.
AnimatedTransform camera_to_world(const AnimatedTransform& node) {
    const auto turned = [](const Transform& t) {
        return without_scale(t) * Transform::scale(1, 1, -1);
    };
    if (!node.is_animated()) return AnimatedTransform(turned(node.start()));
    return {turned(node.start()), node.start_time(), turned(node.end()), node.end_time()};
}

void read_camera(const Document& document, const PlacedNode& placed, SceneDescription& scene) {
    const tinygltf::Node& node = document.model.nodes[static_cast<size_t>(placed.node)];
    const std::string place = element("nodes", static_cast<size_t>(placed.node)) + ".camera";
    const tinygltf::Camera& source =
        at(document, document.model.cameras, node.camera, "cameras", place);
    const std::string here = element("cameras", static_cast<size_t>(node.camera));
    CameraDescription& camera = scene.camera;
    camera.where = document.place(here);
    camera.camera_to_world = camera_to_world(placed.transform);
    if (source.type == "perspective") {
        const double yfov = source.perspective.yfov;
        if (!(yfov > 0 && yfov < M_PI))
            document.refuse(here + ".perspective.yfov", "expected an angle between 0 and pi");
        const double aspect =
            source.perspective.aspectRatio > 0 ? source.perspective.aspectRatio : 16.0 / 9;
        set_film(scene.film, aspect);
        camera.kind = CameraDescription::Kind::perspective;
        const double half = std::tan(yfov / 2) * std::min(1.0, aspect);
        camera.fov = static_cast<float>(2 * std::atan(half)) * kDegrees;
        // The limit is where single precision tells no directions apart any more.
        if (!(camera.fov >= 1e-6f))
            document.refuse(here + ".perspective",
                            "expected a field of view of at least 1e-6 degrees");
    } else if (source.type == "orthographic") {
        const double x = std::abs(source.orthographic.xmag);
        const double y = std::abs(source.orthographic.ymag);
        constexpr double kLeast = 1e-6, kMost = 1e6;
        if (!(x >= kLeast && x <= kMost && y >= kLeast && y <= kMost))
            document.refuse(here + ".orthographic", "expected xmag and ymag from 1e-6 to 1e6");
        set_film(scene.film, x / y);
        camera.kind = CameraDescription::Kind::orthographic;
        const auto w = static_cast<float>(x), h = static_cast<float>(y);
        camera.screen_window = {-w, w, -h, h};
        camera.window_fills_film = false;  // other resolutions show more, nothing is stretched
    } else {
        document.refuse(here + ".type", "expected perspective or orthographic");
    }
}

/// The nodes that place cameras, in their order.
std::vector<const PlacedNode*> nodes_with_cameras(const Document& document,
                                                  const std::vector<PlacedNode>& nodes) {
    std::vector<const PlacedNode*> found;
    for (const PlacedNode& n : nodes)
        if (document.model.nodes[static_cast<size_t>(n.node)].camera >= 0) found.push_back(&n);
    return found;
}

/// The names of placed cameras: the nodes', and the cameras' own.
std::vector<Choosable> names_of(const Document& document,
                                const std::vector<const PlacedNode*>& placed) {
    std::vector<Choosable> names;
    for (const PlacedNode* p : placed) {
        const auto index = static_cast<size_t>(p->node);
        const tinygltf::Node& node = document.model.nodes[index];
        names.push_back({node.name, at(document, document.model.cameras, node.camera, "cameras",
                                       element("nodes", index) + ".camera")
                                        .name});
    }
    return names;
}

}  // namespace

void set_view(const Document& document, const std::vector<PlacedNode>& nodes, const Bounds3& bounds,
              const std::string& choice, SceneDescription& scene, WarningLog& log) {
    const std::vector<const PlacedNode*> placed = nodes_with_cameras(document, nodes);
    const std::vector<Choosable> names = names_of(document, placed);
    const size_t one = choice.empty() ? 0 : chosen({"camera"}, choice, names, "camera");
    if (placed.empty()) {
        set_film(scene.film, 16.0 / 9);
        scene.camera.where = document.place("");
        if (!frame_all(scene)) document.refuse("", "the scene is too large to place a camera");
        scene.no_camera = {
            document.place(""),
            "the scene has no camera; one that sees all of it from the front takes its place"};
    } else {
        read_camera(document, *placed[one], scene);
        if (one > 0) scene.camera_choice = text_of(one, names[one]);
        if (choice.empty() && placed.size() > 1)
            log.add(document.place(element("nodes", static_cast<size_t>(placed[0]->node))),
                    "the first of " + std::to_string(placed.size()) + " cameras is used, " +
                        text_of(0, names[0]) + "; the others are " + listed_without(names, 0));
    }
    const Transform& to_world = scene.camera.camera_to_world.start();
    const float depth = to_world.inverse().point(bounds.center()).z;
    if (depth > 0 && std::isfinite(depth)) scene.camera.focal_distance = depth;
}

}  // namespace covtrace::gltf
