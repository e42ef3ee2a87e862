#include "pbrt/view_builder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "colour/sensor_matrix.h"
#include "colour/white_balance.h"
#include "pbrt/realistic_camera.h"
#include "pbrt/version_three.h"
#include "scene/imaging_scale.h"
#include "scene/names.h"

namespace covtrace {

namespace {

/// Refuses `v`, which is the value of a parameter or its negative, above `most`.
float at_most(const Entity& e, std::string_view name, float v, float most) {
    if (v <= most) return v;
    std::ostringstream limit;
    limit << "parameter " << in_quotes(name) << " is out of range; expected at most " << most
          << " in size";
    e.refuse(name, limit.str());
}

/// Refuses `v`, which is the value of a parameter or a difference of values, outside of [least,
/// most].
float within(const Entity& e, std::string_view name, float v, float least, float most) {
    if (v >= least && v <= most) return v;
    std::ostringstream limit;
    limit << "parameter " << in_quotes(name) << " is out of range; expected a size from " << least
          << " to " << most;
    e.refuse(name, limit.str());
}

/// Least ratio of a film's sides: with it the film still has a size, and its pixels have one.
constexpr float kFlattest = 1e-6f;

std::string owner(std::string_view kind, const Entity& e) {
    return std::string(kind) + " " + in_quotes(e.type);
}

/// The window of a camera, as x0, x1, y0, y1; none where it has none.
std::optional<std::array<float, 4>> screen_window(Entity& e, WarningLog& log) {
    const std::vector<float> window = e.parameters.numbers("screenwindow");
    if (window.empty()) return std::nullopt;
    if (window.size() != 4) {
        log.add(e.parameters.where("screenwindow", e.where),
                "parameter \"screenwindow\" has " + std::to_string(window.size()) +
                    " values in the place of 4 (x0 x1 y0 y1) and is ignored, as in pbrt");
        return std::nullopt;
    }
    if (!(window[0] < window[1] && window[2] < window[3]))
        e.refuse("screenwindow", "parameter \"screenwindow\" expects x0 < x1 and y0 < y1");
    for (const size_t side : {0, 2})
        within(e, "screenwindow", window[side + 1] - window[side], kFlattest, 1 / kFlattest);
    return std::array{window[0], window[1], window[2], window[3]};
}

void read_window(Entity& e, CameraDescription& camera, WarningLog& log) {
    if (e.parameters.has("frameaspectratio"))
        camera.frame_aspect_ratio = within(e, "frameaspectratio", e.positive("frameaspectratio", 0),
                                           kFlattest, 1 / kFlattest);
    camera.screen_window = screen_window(e, log);
}

/// A part of a sphere from two angles in degrees, the lower one first; the whole where it is not
/// given.
std::array<float, 2> part_of_sphere(Entity& e, std::string_view name, std::array<float, 2> whole) {
    const std::vector<float> part = e.parameters.numbers(name);
    if (part.empty()) return whole;
    constexpr float kLeast = 1e-3f;  // degrees; still a part in single precision
    if (part.size() != 2 ||
        !(whole[0] <= part[0] && part[0] + kLeast <= part[1] && part[1] <= whole[1])) {
        std::ostringstream text;
        text << "parameter " << in_quotes(name) << " expects two angles between " << whole[0]
             << " and " << whole[1] << " degrees, the lower one first";
        e.refuse(name, text.str());
    }
    return {part[0], part[1]};
}

void spherical_camera(Entity& e, CameraDescription& camera, WarningLog& log) {
    using Mapping = CameraDescription::Mapping;
    constexpr std::array<std::pair<std::string_view, Mapping>, 4> kMappings{
        {{"equalarea", Mapping::equal_area},
         {"equirectangular", Mapping::equirectangular},
         {"equidistant", Mapping::equidistant},
         {"equisolid", Mapping::equisolid}}};
    camera.kind = CameraDescription::Kind::spherical;
    const std::string mapping = e.parameters.text("mapping", "equalarea");
    const auto* found = std::find_if(kMappings.begin(), kMappings.end(),
                                     [&](const auto& known) { return mapping == known.first; });
    if (found == kMappings.end())
        e.refuse("mapping",
                 unknown_name("mapping of a spherical camera", mapping,
                              {"equalarea", "equirectangular", "equidistant", "equisolid"}));
    camera.mapping = found->second;
    if (camera.mapping == Mapping::equidistant || camera.mapping == Mapping::equisolid) {
        camera.fov = e.positive("fov", 180);
        if (camera.fov > 360 || camera.fov < 1e-3f)
            e.refuse("fov", "parameter \"fov\" of a fisheye must be between 0.001 and 360 degrees");
        read_window(e, camera, log);
    } else if (camera.mapping == Mapping::equirectangular) {
        const auto [left, right] = part_of_sphere(e, "longitude", {0, 360});
        const auto [bottom, top] = part_of_sphere(e, "latitude", {-90, 90});
        camera.sphere_part = {left / 360, right / 360, (90 - top) / 180, (90 - bottom) / 180};
    }
    e.parameters.ignore({"lensradius", "focaldistance", "frameaspectratio", "screenwindow"});
}

/// The blades of a thin lens' aperture, which pbrt-v4 has not.
ApertureBlades aperture_blades(Entity& e) {
    ApertureBlades blades;
    blades.count = e.parameters.integer("apertureblades", 0);
    if (blades.count != 0 && (blades.count < 3 || blades.count > 1000))
        e.refuse("apertureblades", "parameter \"apertureblades\" expects 0 or 3 to 1000 blades");
    const float turn = e.parameters.number("aperturerotation", 0);
    at_most(e, "aperturerotation", std::abs(turn), 1e4f);
    blades.rotation = turn * kPi / 180;
    blades.ratio = within(e, "apertureratio", e.positive("apertureratio", 1), 1e-3f, 1e3f);
    return blades;
}

void thin_lens_camera(Entity& e, CameraDescription& camera, WarningLog& log) {
    ParameterList& p = e.parameters;
    camera.kind = e.type == "perspective" ? CameraDescription::Kind::perspective
                                          : CameraDescription::Kind::orthographic;
    if (e.type == "perspective") camera.fov = p.number("fov", 90);
    if (!(camera.fov > 0 && camera.fov < 180))
        e.refuse("fov", "parameter \"fov\" must be between 0 and 180 degrees");
    // The limit is where single precision tells no directions apart any more.
    constexpr float kNarrowest = 1e-6f;
    if (camera.fov < kNarrowest)
        e.refuse("fov", "parameter \"fov\" is too small; expected at least 1e-6 degrees");
    camera.lens_radius = p.number("lensradius", 0);
    if (camera.lens_radius < 0)
        e.refuse("lensradius", "parameter \"lensradius\" must not be negative");
    camera.focal_distance = e.positive("focaldistance", 1e6f);
    camera.blades = aperture_blades(e);
    read_window(e, camera, log);
}

void build_camera(ViewEntities& view, BuildContext& context) {
    Entity& e = view.camera;
    ParameterList& p = e.parameters;
    CameraDescription& camera = context.scene.camera;
    camera.where = e.where;
    camera.camera_to_world = view.camera_to_world;
    camera.shutter_open = p.number("shutteropen", 0);
    camera.shutter_close = p.number("shutterclose", 1);
    if (!(camera.shutter_open < camera.shutter_close))
        e.refuse(p.has("shutterclose") ? "shutterclose" : "shutteropen",
                 "the shutter never opens: expected shutteropen < shutterclose");
    if (e.type == "perspective" || e.type == "orthographic") {
        thin_lens_camera(e, camera, context.log);
    } else if (e.type == "realistic") {
        build_realistic_camera(e, view.film, context);
    } else if (e.type == "spherical") {
        spherical_camera(e, camera, context.log);
    } else {
        throw unknown_type_error(e.where, "camera", e.type,
                                 {"perspective", "orthographic", "realistic", "spherical"});
    }
    p.warn_unused(context.log, owner("camera", e));
}

void set_crop(Entity& e, FilmDescription& film, WarningLog& log) {
    if (const std::vector<int> b = e.parameters.integers("pixelbounds"); !b.empty()) {
        if (b.size() != 4) e.refuse("pixelbounds", "parameter \"pixelbounds\" expects x0 x1 y0 y1");
        const std::array<int, 4> inside{std::max(b[0], 0), std::min(b[1], film.width),
                                        std::max(b[2], 0), std::min(b[3], film.height)};
        if (inside[0] >= inside[1] || inside[2] >= inside[3])
            e.refuse("pixelbounds", "parameter \"pixelbounds\" leaves no pixel of the image");
        if (!std::equal(inside.begin(), inside.end(), b.begin()))
            log.add(e.parameters.where("pixelbounds", e.where),
                    "\"pixelbounds\" reach beyond the image; cut to its size");
        film.pixel_bounds = inside;
    }
    if (const std::vector<float> c = e.parameters.numbers("cropwindow"); !c.empty()) {
        if (c.size() != 4) e.refuse("cropwindow", "parameter \"cropwindow\" expects x0 x1 y0 y1");
        const SourceLocation where = e.parameters.where("cropwindow", e.where);
        film.crop_window = {clamp01(std::min(c[0], c[1])), clamp01(std::max(c[0], c[1])),
                            clamp01(std::min(c[2], c[3])), clamp01(std::max(c[2], c[3]))};
        const auto& w = film.crop_window;
        if (!(w[0] < w[1] && w[2] < w[3]))
            e.refuse("cropwindow", "parameter \"cropwindow\" leaves no pixel of the image");
        if (film.pixel_bounds) {
            log.add(where, "both \"pixelbounds\" and \"cropwindow\" are given; the latter counts");
            film.pixel_bounds.reset();
        }
    }
}

FilmDescription::Surfaces gbuffer_space(Entity& e) {
    const std::string space = e.parameters.text("coordinatesystem", "camera");
    if (space == "world") return FilmDescription::Surfaces::world;
    if (space == "camera") return FilmDescription::Surfaces::camera;
    e.refuse("coordinatesystem",
             unknown_name("coordinate system of a gbuffer film", space, {"camera", "world"}));
}

void set_sensor(Entity& e, BuildContext& context) {
    FilmDescription& film = context.scene.film;
    ParameterList& p = e.parameters;
    const float balance = p.number("whitebalance", 0);
    if (balance < 0) e.refuse("whitebalance", "parameter \"whitebalance\" must not be negative");
    if (const std::string name = p.text("sensor", "cie1931"); name != "cie1931") {
        const SensorCurves* sensor = find_sensor(name);
        if (!sensor) e.refuse("sensor", unknown_name("sensor", name, sensor_names()));
        const SensorMatrices matrices = sensor_matrices(*sensor, balance > 0 ? balance : 6500);
        film.sensor = matrices.shown;
        film.sensor_values = matrices.values;
        context.sensor.emplace(*sensor, matrices);
    } else if (balance > 0) {
        film.sensor = white_balance(balance);
        film.sensor_values = xyz_before_balance(balance);
    }
}

void build_film(ViewEntities& view, BuildContext& context) {
    Entity& e = view.film;
    ParameterList& p = e.parameters;
    FilmDescription& film = context.scene.film;
    film.where = e.where;
    if (e.type == "gbuffer") {
        film.surfaces = gbuffer_space(e);
    } else if (e.type == "spectral") {
        context.log.add(e.where, "film \"spectral\" is not supported; \"rgb\" takes its place");
        p.ignore({"nbuckets", "lambdamin", "lambdamax"});
    } else if (e.type != "rgb") {
        throw unknown_type_error(e.where, "film", e.type, {"rgb", "gbuffer", "spectral"});
    }
    film.width = p.integer("xresolution", 1280);
    film.height = p.integer("yresolution", 720);
    const bool bad_width = film.width < 1;
    const std::string resolution = std::to_string(film.width) + "x" + std::to_string(film.height);
    if (film.width < 1 || film.height < 1)
        e.refuse(bad_width ? "xresolution" : "yresolution",
                 "the resolution " + resolution + " has no pixels");
    if (film.is_too_large())
        throw Error(ErrorKind::limit, p.where("xresolution", e.where),
                    "the resolution " + resolution + " is too large; " + film.kLargest);
    film.filename = p.text("filename");
    film.iso = e.positive("iso", 100);
    film.max_component_value = e.positive("maxcomponentvalue", kInfinity);
    set_crop(e, film, context.log);
    set_sensor(e, context);
    if (view.film_colour_space != ColourSpace::srgb)
        context.log.add(e.where,
                        "the image is written in linear Rec.709, not in the film's colour space");
    p.ignore({"diagonal", "savefp16"});
    p.warn_unused(context.log, owner("film", e));
}

void build_filter(Entity& e, BuildContext& context) {
    using Kind = FilterDescription::Kind;
    struct Default {
        const char* name;
        Kind kind;
        float radius;
    };
    constexpr std::array<Default, 5> known{{{"box", Kind::box, 0.5f},
                                            {"triangle", Kind::triangle, 2},
                                            {"gaussian", Kind::gaussian, 1.5f},
                                            {"mitchell", Kind::mitchell, 2},
                                            {"sinc", Kind::lanczos_sinc, 4}}};
    const auto it = std::find_if(known.begin(), known.end(),
                                 [&](const Default& d) { return e.type == d.name; });
    if (it == known.end())
        throw unknown_type_error(e.where, "filter", e.type,
                                 {"box", "triangle", "gaussian", "mitchell", "sinc"});
    FilterDescription& filter = context.scene.filter;
    filter.kind = it->kind;
    const bool is_sinc = filter.kind == Kind::lanczos_sinc;
    // The limits: a filter wider than the widest image says nothing; a sinc has to be sampled finer
    // than it swings.
    constexpr float kWidest = 65536, kSwings = 128;
    const float widest = is_sinc ? kSwings : kWidest;
    filter.x_radius = at_most(e, "xradius", e.positive("xradius", it->radius), widest);
    filter.y_radius = at_most(e, "yradius", e.positive("yradius", it->radius), widest);
    if (filter.kind == Kind::gaussian) filter.sigma = e.positive("sigma", 0.5f);
    if (filter.kind == Kind::mitchell) {
        // Beyond the limit a pixel is the difference of numbers ten times as large and more: noise
        // alone.
        constexpr float kLargest = 10;
        for (const auto& [name, value] : {std::pair("B", &filter.b), std::pair("C", &filter.c)}) {
            *value = at_most(e, name, e.parameters.number(name, 1.0f / 3), kLargest);
            at_most(e, name, -*value, kLargest);
        }
    }
    if (is_sinc) {
        filter.tau = e.positive("tau", 3);
        if (filter.tau * kSwings < std::max(filter.x_radius, filter.y_radius))
            e.refuse("tau", "parameter \"tau\" is too small; expected at least the radius / 128");
    }
    e.parameters.warn_unused(context.log, owner("filter", e));
}

void build_sampler(Entity& e, BuildContext& context) {
    const std::vector<std::string> known{"zsobol",  "halton",      "sobol",     "paddedsobol",
                                         "pmj02bn", "independent", "stratified"};
    if (std::find(known.begin(), known.end(), e.type) == known.end())
        throw unknown_type_error(e.where, "sampler", e.type, known);
    ParameterList& p = e.parameters;
    int64_t samples = 0;
    if (e.type == "stratified") {
        const int x = p.integer("xsamples", 4), y = p.integer("ysamples", 4);
        samples = x < 1 || y < 1 ? 0 : int64_t{x} * y;
    } else {
        samples = p.integer("pixelsamples", e.type == "independent" ? 4 : 16);
    }
    constexpr int64_t most = int64_t{1} << 30;
    if (samples < 1 || samples > most)
        e.refuse(e.type == "stratified" ? "xsamples" : "pixelsamples",
                 "expected from 1 to 2^30 samples per pixel");
    context.scene.samples_per_pixel = static_cast<int>(samples);
    p.ignore({"seed", "randomization", "jitter"});
    p.warn_unused(context.log, owner("sampler", e));
}

void build_integrator(Entity& e, BuildContext& context) {
    ParameterList& p = e.parameters;
    context.scene.max_depth = p.integer("maxdepth", 5);
    if (context.scene.max_depth < 0)
        e.refuse("maxdepth", "parameter \"maxdepth\" must not be negative");
    const std::vector<std::string> known{
        "path", "volpath", "simplepath", "simplevolpath",    "lightpath", "bdpt",
        "mlt",  "sppm",    "randomwalk", "ambientocclusion", "function"};
    if (std::find(known.begin(), known.end(), e.type) == known.end())
        throw unknown_type_error(e.where, "integrator", e.type, known);
    if (e.type != "path" && e.type != "volpath") {
        // These trace light from lights without extent, too, which no path from the camera meets
        const bool traces_light =
            e.type == "bdpt" || e.type == "mlt" || e.type == "sppm" || e.type == "lightpath";
        context.log.add(
            e.where,
            "integrator " + in_quotes(e.type) + " is not supported; path tracing takes its place" +
                (traces_light ? ", without caustics of point, spot and distant lights" : ""));
        p.ignore_all();
    }
    const std::vector<std::string> volumetric{"volpath", "simplevolpath", "bdpt", "mlt"};
    context.scene.renders_media =
        std::find(volumetric.begin(), volumetric.end(), e.type) != volumetric.end();
    context.scene.regularizes = p.flag("regularize", false);
    context.scene.adapts_colours = !p.flag("channelbychannel", false);
    p.ignore({"lightsampler"});
    p.warn_unused(context.log, owner("integrator", e));
}

}  // namespace

void build_view(ViewEntities& view, BuildContext& context) {
    const auto at = [&](const Entity& e) { context.log.set_order(e.directive); };
    at(view.film), build_film(view, context);
    at(view.camera), build_camera(view, context);
    if (!std::isfinite(imaging_scale(context.scene)))
        view.camera.refuse(
            "shutterclose",
            "the film's iso times the shutter's time is too large for single precision");
    at(view.filter), build_filter(view.filter, context);
    at(view.sampler), build_sampler(view.sampler, context);
    at(view.integrator), build_integrator(view.integrator, context);
    at(view.accelerator);
    if (const std::string& type = view.accelerator.type; type != "bvh" && type != "kdtree")
        context.log.add(view.accelerator.where,
                        "accelerator " + in_quotes(type) + " is not known; ignored");
}

}  // namespace covtrace
