#include "pbrt/medium_builder.h"

#include <algorithm>
#include <array>
#include <optional>

#include "pbrt/named_media.h"
#include "pbrt/spectrum_parameter.h"
#include "pbrt/version_three.h"
#include "scene/names.h"

namespace covtrace {

namespace {

Rgb coefficient(ParameterList& p, std::string_view name, BuildContext& context) {
    const Parameter* given =
        p.find(name, {ParameterType::rgb, ParameterType::spectrum, ParameterType::blackbody});
    return given ? factor_colour(*given, context) : Rgb{1};
}

float not_negative(Entity& e, std::string_view name) {
    const float v = e.parameters.number(name, 1);
    if (!(v >= 0)) e.refuse(name, "parameter " + in_quotes(name) + " must not be negative");
    return v;
}

float mean_cosine(Entity& e) {
    const float g = e.parameters.number("g", 0);
    if (!(g > -1 && g < 1)) e.refuse("g", "parameter \"g\" must be between -1 and 1");
    return g;
}

void homogeneous(MediumDescription& medium, Entity& e, BuildContext& context) {
    ParameterList& p = e.parameters;
    std::optional<NamedMedium> preset;
    if (const std::string name = p.text("preset"); !name.empty()) {
        preset = named_medium(name);
        if (!preset)
            context.log.add(p.where("preset", e.where),
                            "medium " + in_quotes(medium.name) + ": the preset " + in_quotes(name) +
                                " is not known" + did_you_mean(name, medium_names()) +
                                "; its sigma_a and sigma_s count");
    }
    const float scale = not_negative(e, "scale");
    medium.sigma_a = (preset ? preset->sigma_a : coefficient(p, "sigma_a", context)) * scale;
    medium.sigma_s = (preset ? preset->sigma_s : coefficient(p, "sigma_s", context)) * scale;
    const float emission = not_negative(e, "Lescale");
    if (p.has("Le"))
        medium.emission =
            scaled_light(light_colour(p, "Le", context), emission, p.where("Le", e.where), context);
    p.warn_unused(context.log, "media of type \"homogeneous\"");
}

/// Mean of the grid values of one parameter, 1 where it isn't given; `stride` numbers make one
/// value. Errors: Error(scene) where there are not nx ny nz values.
Rgb grid_mean(Entity& e, std::string_view name, size_t stride) {
    ParameterList& p = e.parameters;
    const Parameter* given = p.find(name, {ParameterType::floats, ParameterType::rgb});
    if (!given) return Rgb{1};
    const std::vector<float>& values = given->numbers;
    double cells = 1;
    for (const char* side : {"nx", "ny", "nz"}) cells *= std::max(p.integer(side, 1), 0);
    if (double(values.size()) != cells * double(stride))
        throw Error(ErrorKind::scene, given->where,
                    "parameter " + in_quotes(name) + " has " +
                        std::to_string(values.size() / stride) +
                        " values; expected nx * ny * nz of them");
    std::array<double, 3> sum{};
    for (size_t i = 0; i < values.size(); ++i) sum[stride == 3 ? i % 3 : 0] += values[i];
    if (stride == 1) sum[1] = sum[2] = sum[0];
    const auto mean = [&](double s) { return static_cast<float>(std::max(0.0, s / cells)); };
    return {mean(sum[0]), mean(sum[1]), mean(sum[2])};
}

/// Makes an even medium with the mean coefficients of a grid.
void grid(MediumDescription& medium, const std::string& type, Entity& e, BuildContext& context) {
    ParameterList& p = e.parameters;
    const float scale = not_negative(e, "scale");
    if (type == "uniformgrid") {
        if (!p.has("density"))
            throw Error(
                ErrorKind::scene, e.where,
                "medium " + in_quotes(medium.name) + " has no grid; expected \"float density\"");
        const float density = grid_mean(e, "density", 1).r;
        medium.sigma_a = coefficient(p, "sigma_a", context) * (scale * density);
        medium.sigma_s = coefficient(p, "sigma_s", context) * (scale * density);
    } else {
        medium.sigma_a = grid_mean(e, "sigma_a", 3) * scale;
        medium.sigma_s = grid_mean(e, "sigma_s", 3) * scale;
    }
    context.log.add(e.where, "medium " + in_quotes(medium.name) + ": grids of type " +
                                 in_quotes(type) +
                                 " are not rendered; an even medium of their mean density fills "
                                 "the whole shape" +
                                 (p.has("Le") || p.has("temperature") ? " and does not emit" : ""));
    p.ignore_all();
}

}  // namespace

MediumDescription build_medium(std::string name, Entity& e, BuildContext& context) {
    MediumDescription medium;
    medium.name = std::move(name);
    medium.where = e.where;
    const std::string label = "medium " + in_quotes(medium.name);
    const std::string type = e.parameters.text("type");
    if (type.empty())
        throw Error(ErrorKind::scene, e.where, label + " has no type; expected \"string type\"");
    if (type != "cloud" && type != "nanovdb") medium.g = mean_cosine(e);
    if (type == "homogeneous") {
        homogeneous(medium, e, context);
    } else if (type == "uniformgrid" || type == "rgbgrid") {
        grid(medium, type, e, context);
    } else if (type == "cloud" || type == "nanovdb") {
        context.log.add(e.where, label + ": media of type " + in_quotes(type) +
                                     " are not rendered; empty space takes its place");
        e.parameters.ignore_all();
    } else {
        throw unknown_type_error(e.parameters.where("type", e.where), "medium", type,
                                 {"homogeneous", "uniformgrid", "rgbgrid", "cloud", "nanovdb"});
    }
    return medium;
}

}  // namespace covtrace
