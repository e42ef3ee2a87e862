#include "scene/medium_builder.h"

#include <algorithm>

#include "scene/names.h"
#include "scene/spectrum_parameter.h"
#include "scene/version_three.h"

namespace covtrace {

namespace {

Rgb coefficient(ParameterList& p, std::string_view name, BuildContext& context) {
    const Parameter* given =
        p.find(name, {ParameterType::rgb, ParameterType::spectrum, ParameterType::blackbody});
    return given ? factor_colour(*given, context) : Rgb{1};
}

}  // namespace

MediumDescription build_medium(std::string name, Entity& e, BuildContext& context) {
    ParameterList& p = e.parameters;
    MediumDescription medium;
    medium.name = std::move(name);
    medium.where = e.where;
    const std::string label = "medium " + in_quotes(medium.name);
    const std::string type = p.text("type");
    if (type.empty())
        throw Error(ErrorKind::scene, e.where, label + " has no type; expected \"string type\"");
    const std::vector<std::string> grids{"uniformgrid", "rgbgrid", "cloud", "nanovdb"};
    if (std::find(grids.begin(), grids.end(), type) != grids.end()) {
        context.log.add(e.where, label + ": media of type " + in_quotes(type) +
                                     " are not rendered; empty space takes its place");
        return medium;
    }
    if (type != "homogeneous") {
        std::vector<std::string> known = grids;
        known.insert(known.begin(), "homogeneous");
        throw unknown_type_error(p.where("type", e.where), "medium", type, known);
    }
    if (const std::string preset = p.text("preset"); !preset.empty())
        context.log.add(p.where("preset", e.where),
                        label + ": the preset " + in_quotes(preset) +
                            " is not known; its sigma_a and sigma_s count");
    const float scale = p.number("scale", 1);
    if (scale < 0)
        throw Error(ErrorKind::scene, p.where("scale", e.where),
                    "parameter \"scale\" must not be negative");
    medium.sigma_a = coefficient(p, "sigma_a", context) * scale;
    medium.sigma_s = coefficient(p, "sigma_s", context) * scale;
    medium.g = p.number("g", 0);
    if (!(medium.g > -1 && medium.g < 1))
        throw Error(ErrorKind::scene, p.where("g", e.where),
                    "parameter \"g\" must be between -1 and 1");
    if (!is_black(medium.sigma_s))
        context.log.add(e.where, label + " scatters light; only its absorption is rendered");
    if (p.has("Le"))
        context.log.add(p.where("Le", e.where), label + " emits light, which is not rendered");
    p.ignore({"Le", "Lescale"});
    p.warn_unused(context.log, "media of type \"homogeneous\"");
    return medium;
}

}  // namespace covtrace
