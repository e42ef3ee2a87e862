#include "render/render_identity.h"

#include <iomanip>
#include <sstream>

#include "render/overrides.h"
#include "render/version.h"

namespace covtrace {

namespace {

/// Words for two values that differ. Some values are "given" and "not given", which "A, not B"
/// would say the wrong way round.
std::string contrast(const std::string& is, const std::string& expected) {
    if (is.starts_with("not ") || expected.starts_with("not "))
        return is + " there, " + expected + " here";
    return is + ", not " + expected;
}

std::string text(double v) {
    std::ostringstream out;
    out << std::setprecision(9) << v;  // enough digits to tell any two floats apart
    return out.str();
}
std::string text(const PixelBounds& b) {
    return text(b.x0) + "," + text(b.y0) + "," + text(b.x1) + "," + text(b.y1);
}
template <typename T>
std::string text(const std::optional<T>& v) {
    return v ? text(double(*v)) : "by default";
}

}  // namespace

std::string scene_hash(const RenderScene& scene) {
    std::ostringstream out;
    out << std::hex << std::setw(16) << std::setfill('0') << scene.description.content_hash;
    return out.str();
}

RenderIdentity render_identity(const RenderScene& scene, const RenderOptions& options) {
    const SceneDescription& d = scene.description;
    RenderIdentity id{
        {"version", program_version()},
        {"scene", scene_hash(scene)},
        {"instruction set", scene.geometry.isa()},
        {"--method", std::string(name_of(options.method))},
        {"--seed", std::to_string(options.seed)},
        {"--resolution", text(d.film.width) + "x" + text(d.film.height)},
        {"--crop", text(render_region(d.film))},
        {"--max-depth", text(d.max_depth)},
        {"--shutter", text(d.camera.shutter_open) + "," + text(d.camera.shutter_close)},
        {"--focus", text(d.camera.focal_distance)},
        {"lens radius (--fstop)", text(d.camera.lens_radius)},
    };
    id["--guides"] = std::string(name_of(scene.guides));
    id["--max-spp"] = text(options.max_spp);
    id["--camera"] = !d.camera_override.empty() ? d.camera_override
                     : !d.camera_choice.empty() ? d.camera_choice
                                                : "the scene's";
    id["--gltf-scene"] = d.gltf_scene_choice.empty() ? "the file's own" : d.gltf_scene_choice;
    id["--variant"] = d.variant_choice.empty() ? "the file's own" : d.variant_choice;
    id["--animation"] = d.animation_choice.empty() ? "all" : d.animation_choice;
    id["--environment"] = d.environment_override.empty() ? "the scene's" : d.environment_override;
    id["--light"] = d.lamps_text.empty() ? "none" : d.lamps_text;
    id["--frames"] = d.swept.empty() ? "not given" : "given";
    using Surfaces = FilmDescription::Surfaces;
    if (const Surfaces kept = kept_surfaces(d.film, options); kept != Surfaces::none)
        id["first surfaces (--layers)"] =
            kept == Surfaces::camera ? "in the camera's space" : "in the world";
    if (options.method == Method::uniform) {
        id["light of emitters (--layers)"] = options.emitters_apart ? "apart" : "not apart";
        id["features (--layers)"] = options.features ? "kept" : "not kept";
        return id;
    }
    id["--cov-spp"] = text(options.cov_spp);
    id["--brdf-covariance"] = std::string(name_of(options.brdf_covariance));
    id["--texture-bandwidth"] = std::string(name_of(options.texture_bandwidth));
    id["--occlusion"] = std::string(name_of(options.occlusion));
    if (asks_grid(options.occlusion)) id["--voxels"] = text(options.voxels);
    if (options.method == Method::covariance) {
        id["--density"] = std::string(name_of(options.density));
        id["--progressive"] = options.progressive ? "given" : "not given";
        id["--filter"] = std::string(name_of(options.filter));
    } else {
        id["--even-counts"] = options.even_counts ? "given" : "not given";
    }
    return id;
}

std::string program_version() {
    return std::string(kVersion) + " (" + std::string(kCommit) + ")";
}

std::optional<std::string> difference(const RenderIdentity& is, const RenderIdentity& expected) {
    // The properties that explain the rest come first.
    for (const char* first : {"version", "scene", "images", "--method", "--resolution"})
        if (is.count(first) && expected.count(first) && is.at(first) != expected.at(first))
            return std::string(first) + ": " + contrast(is.at(first), expected.at(first));
    for (const auto& [name, value] : expected) {
        const auto it = is.find(name);
        if (it == is.end()) return name + ": not told, not " + value;
        if (it->second != value) return name + ": " + contrast(it->second, value);
    }
    return std::nullopt;
}

}  // namespace covtrace
