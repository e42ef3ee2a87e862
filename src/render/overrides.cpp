#include "render/overrides.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "core/vec.h"
#include "render/camera_override.h"
#include "render/environment_override.h"
#include "scene/added_lamps.h"
#include "scene/defaults.h"
#include "scene/framing.h"

namespace covtrace {

namespace {

/// Another resolution shows the same picture: a crop given in pixels keeps its place in the frame.
void set_resolution(const std::array<int, 2>& resolution, FilmDescription& film) {
    if (film.pixel_bounds) {
        const auto& b = *film.pixel_bounds;
        film.crop_window = {float(b[0]) / float(film.width), float(b[1]) / float(film.width),
                            float(b[2]) / float(film.height), float(b[3]) / float(film.height)};
        film.pixel_bounds.reset();
    }
    film.width = resolution[0];
    film.height = resolution[1];
    if (film.is_too_large())
        throw Error(ErrorKind::limit, OptionName{"resolution"},
                    std::to_string(film.width) + "x" + std::to_string(film.height) +
                        " is too large; " + film.kLargest);
}

void set_crop(const PixelBounds& c, FilmDescription& film) {
    if (c.x0 < 0 || c.y0 < 0 || c.x1 > film.width || c.y1 > film.height || c.x0 >= c.x1 ||
        c.y0 >= c.y1)
        throw Error(ErrorKind::usage, OptionName{"crop"},
                    "the pixels must lie inside the frame of " + std::to_string(film.width) + "x" +
                        std::to_string(film.height) + " pixels and hold at least one");
    film.pixel_bounds = {c.x0, c.x1, c.y0, c.y1};
}

/// Opens the lens to an f-number: focal length over the diameter of the aperture.
void open_lens(float f_number, CameraDescription& camera) {
    if (camera.kind != CameraDescription::Kind::perspective)
        throw Error(ErrorKind::usage, OptionName{"fstop"},
                    "orthographic and spherical cameras have no focal length; expected a "
                    "perspective one, as by --camera");
    // A lens that is not the scene's own is that of a full-frame sensor, 24 mm high: focal length
    // from the field of view, in metres.
    const float focal_length = camera.lens
                                   ? float(paraxial_lens(camera.lens->surfaces).focal_length)
                                   : 0.012f / std::tan(camera.fov * kPi / 360);
    camera.lens_radius = focal_length / (2 * f_number);
}

/// Tells that a focal distance changes nothing where the lens is closed.
void warn_of_closed_lens(SceneDescription& scene) {
    if (scene.camera.lens_radius > 0) return;
    const bool may_open = scene.camera.kind == CameraDescription::Kind::perspective;
    scene.warnings.push_back(
        {{},
         std::string("--focus changes nothing: the camera's lens is closed") +
             (may_open ? ", and all is sharp until --fstop opens it" : ", and all is sharp")});
}

}  // namespace

void apply(const SceneOverrides& overrides, SceneDescription& scene) {
    if (overrides.resolution) set_resolution(*overrides.resolution, scene.film);
    if (overrides.crop) set_crop(*overrides.crop, scene.film);
    if (overrides.shutter) {
        scene.camera.shutter_open = (*overrides.shutter)[0];
        scene.camera.shutter_close = (*overrides.shutter)[1];
    }
    if (overrides.camera) override_camera(*overrides.camera, scene);
    // In a narrower picture it may stand farther away: what was not too large at first still isn't.
    if (overrides.resolution && is_framed(scene) && !frame_all(scene))
        throw Error(ErrorKind::scene, "the scene is too large to place a camera");
    if (overrides.focal_distance) scene.camera.focal_distance = *overrides.focal_distance;
    if (overrides.f_number) open_lens(*overrides.f_number, scene.camera);
    if (overrides.focal_distance) warn_of_closed_lens(scene);
    if (overrides.max_depth) scene.max_depth = *overrides.max_depth;
    add_lamps(overrides.lamps, scene);
    if (overrides.environment) replace_environment(*overrides.environment, scene);
    complete(scene);
    change_environment(overrides, scene);
}

PixelBounds render_region(const FilmDescription& film) {
    if (film.pixel_bounds) {
        const auto& b = *film.pixel_bounds;
        return {std::max(0, b[0]), std::max(0, b[2]), std::min(film.width, b[1]),
                std::min(film.height, b[3])};
    }
    const auto pixel = [](float fraction, int size) {
        return int(std::ceil(fraction * float(size)));
    };
    const auto& c = film.crop_window;
    return {std::clamp(pixel(c[0], film.width), 0, film.width),
            std::clamp(pixel(c[2], film.height), 0, film.height),
            std::clamp(pixel(c[1], film.width), 0, film.width),
            std::clamp(pixel(c[3], film.height), 0, film.height)};
}

}  // namespace covtrace
