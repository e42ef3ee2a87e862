#include "pbrt/realistic_camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <sstream>
#include <utility>

#include "pbrt/lens_file.h"
#include "scene/names.h"

namespace covtrace {

namespace {

constexpr float kMillimetre = 1e-3f;  // in scene units

ApertureShape aperture_shape(Entity& e, BuildContext& context) {
    using Kind = ApertureShape::Kind;
    constexpr std::array<std::pair<const char*, Kind>, 5> shapes{{{"circular", Kind::round},
                                                                  {"gaussian", Kind::gaussian},
                                                                  {"square", Kind::square},
                                                                  {"pentagon", Kind::pentagon},
                                                                  {"star", Kind::star}}};
    const std::string name = e.parameters.text("aperture");
    const SourceLocation where = e.parameters.where("aperture", e.where);
    if (name.empty()) return {};
    for (const auto& [known, kind] : shapes)
        if (name == known) return {kind, {}, where};
    return {Kind::image, context.files.find(name, where), where};
}

/// Radius of the entrance pupil for an aperture of this diameter.
float pupil_radius(Entity& e, float diameter, const LensDescription& lens,
                   const ParaxialLens& paraxial, WarningLog& log) {
    const std::optional<size_t> stop = aperture_stop(lens.surfaces);
    if (!stop) return float(paraxial.widest_pupil);
    const float widest = lens.surfaces[*stop].aperture_radius;
    float radius = 0.5f * diameter * kMillimetre;
    if (radius > widest) {
        std::ostringstream text;
        text << "the lens opens to " << 2 * widest / kMillimetre
             << " mm only, which is taken for the aperture";
        log.add(e.parameters.where("aperturediameter", e.where), text.str());
        radius = widest;
    }
    return std::min(float(radius / paraxial.stop_per_pupil), float(paraxial.widest_pupil));
}

/// Distance of the film behind the lens that stands for the camera's.
float focused(Entity& e, const ParaxialLens& paraxial, float focus_distance) {
    if (const auto distance = paraxial.image_distance(focus_distance)) return float(*distance);
    std::ostringstream text;
    text << "the lens does not focus as near as this; expected more than "
         << paraxial.nearest_focus();
    e.refuse("focusdistance", text.str());
}

}  // namespace

void build_realistic_camera(Entity& e, Entity& film_entity, BuildContext& context) {
    ParameterList& p = e.parameters;
    CameraDescription& camera = context.scene.camera;
    const std::string file = p.text("lensfile");
    if (file.empty())
        throw Error(ErrorKind::scene, e.where,
                    "a realistic camera has no lens; expected \"string lensfile\"");
    const SourceLocation where = p.where("lensfile", e.where);
    const float diameter = e.positive("aperturediameter", 1);
    camera.focal_distance = e.positive("focusdistance", 10);
    auto lens = std::make_shared<LensDescription>();
    lens->film_diagonal = film_entity.positive("diagonal", 35) * kMillimetre;
    float behind = 0;  // distance from the lens that stands for this one to the film
    if (const auto found = context.files.find_optional(file, where)) {
        lens->surfaces = read_lens(context.files.read(*found, where), file, where);
        lens->aperture = aperture_shape(e, context);
        const ParaxialLens paraxial = paraxial_lens(lens->surfaces);
        camera.lens_radius = pupil_radius(e, diameter, *lens, paraxial, context.log);
        behind = focused(e, paraxial, camera.focal_distance);
        camera.lens = lens;
    } else {
        // A double Gauss lens of full frame stands in where scenes come without their lens.
        constexpr float kFocalLength = 0.05f;
        camera.lens_radius = 0.5f * diameter * kMillimetre;
        behind = camera.focal_distance > 2 * kFocalLength
                     ? 1 / (1 / kFocalLength - 1 / camera.focal_distance)
                     : kFocalLength;
        p.ignore({"aperture"});
        context.log.add(e.where, "camera \"realistic\": the lens " + in_quotes(file) +
                                     " was not found; a thin lens of 50 mm takes its place");
    }
    const FilmDescription& film = context.scene.film;
    const auto w = static_cast<float>(film.width), h = static_cast<float>(film.height);
    const float shorter = lens->film_diagonal * std::min(w, h) / std::sqrt(w * w + h * h);
    camera.fov = 2 * std::atan(0.5f * shorter / behind) * (180 / kPi);
    // pbrt's other cameras take radiance for what the film gets; this one takes irradiance.
    camera.film_irradiance = kPi * sqr(camera.lens_radius / behind);
}

}  // namespace covtrace
