#include "pbrt/medium_builder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>

#include "pbrt/named_media.h"
#include "pbrt/spectrum_parameter.h"
#include "pbrt/version_three.h"
#include "scene/names.h"
#include "volume/cloud.h"
#include "volume/nanovdb_grid.h"

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

/// The coefficients of a preset or of the parameters themselves, with their scale.
void coefficients(MediumDescription& medium, Entity& e, BuildContext& context) {
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
}

void homogeneous(MediumDescription& medium, Entity& e, BuildContext& context) {
    ParameterList& p = e.parameters;
    coefficients(medium, e, context);
    const float emission = not_negative(e, "Lescale");
    if (p.has("Le"))
        medium.emission =
            scaled_light(light_colour(p, "Le", context), emission, p.where("Le", e.where), context);
}

/// The numbers of cells along the axes. Errors: Error(scene) where one is not positive.
LatticePlace cells(Entity& e) {
    LatticePlace n;
    const std::array<const char*, 3> names{"nx", "ny", "nz"};
    for (size_t a = 0; a < 3; ++a) {
        n[a] = e.parameters.integer(names[a], 1);
        if (n[a] < 1)
            e.refuse(names[a], "parameter " + in_quotes(names[a]) + " must be greater than 0");
    }
    return n;
}

/// The box of a grid, of pbrt's parameters p0 and p1.
Bounds3 box_of(Entity& e) {
    const Vec3 p0 = e.parameters.triple("p0", {}), p1 = e.parameters.triple("p1", {1, 1, 1});
    const Bounds3 box{min(p0, p1), max(p0, p1)};
    const Vec3 side = box.diagonal();
    if (!(side.x > 0 && side.y > 0 && side.z > 0))
        e.refuse("p1", "the box from \"p0\" to \"p1\" is flat");
    if (!(std::isfinite(side.x) && std::isfinite(side.y) && std::isfinite(side.z)))
        e.refuse("p1", "the box from \"p0\" to \"p1\" is too large");
    return box;
}

/// A grid of values over a box, one in the middle of each of its cells. Beyond the outermost ones
/// they fall to 0, and outside of the box there is nothing, as in pbrt.
std::shared_ptr<const DensityGrid> cell_grid(std::span<const float> values, const LatticePlace& n,
                                             const Bounds3& box, const Transform& medium_from_world,
                                             const SourceLocation& where) {
    const Vec3 count{float(n[0]), float(n[1]), float(n[2])}, side = box.diagonal();
    const Transform lattice_from_medium =
        Transform::translate({-0.5f, -0.5f, -0.5f}) *
        Transform::scale(count.x / side.x, count.y / side.y, count.z / side.z) *
        Transform::translate(-box.lo);
    const auto value = [&](const LatticePlace& at) {
        return values[size_t(at[0]) +
                      size_t(n[0]) * (size_t(at[1]) + size_t(n[1]) * size_t(at[2]))];
    };
    return std::make_shared<const DensityGrid>(
        lattice_from_medium * medium_from_world,
        Bounds3{{-0.5f, -0.5f, -0.5f}, count - Vec3{0.5f, 0.5f, 0.5f}},
        Lattice{{}, {n[0] - 1, n[1] - 1, n[2] - 1}, value}, where);
}

/// The numbers of a parameter of a grid, `stride` for each cell; empty where it is not given.
/// Errors: Error(scene) where they are too few, too many or negative.
std::span<const float> cell_values(Entity& e, std::string_view name, ParameterType type,
                                   const LatticePlace& n) {
    const Parameter* given = e.parameters.find(name, {type});
    if (!given) return {};
    const std::vector<float>& values = given->numbers;
    const size_t stride = type == ParameterType::rgb ? 3 : 1;
    if (double(values.size()) != double(n[0]) * n[1] * n[2] * double(stride))
        e.refuse(name, "parameter " + in_quotes(name) + " has " +
                           std::to_string(values.size() / stride) +
                           " values; expected nx * ny * nz of them");
    if (std::ranges::any_of(values, [](float v) { return v < 0; }))
        e.refuse(name, "parameter " + in_quotes(name) + " must not be negative");
    return values;
}

/// The colours of a parameter of a grid, three numbers for each cell, from the file's colour space;
/// empty where it is not given. Errors: as those of `cell_values`.
std::vector<float> cell_colours(Entity& e, std::string_view name, const LatticePlace& n) {
    const std::span<const float> given = cell_values(e, name, ParameterType::rgb, n);
    std::vector<float> values(given.begin(), given.end());
    const Parameter* p = e.parameters.find(name, {ParameterType::rgb});
    if (!p || p->colour_space == ColourSpace::srgb) return values;
    for (size_t i = 0; i < values.size(); i += 3) {
        const Rgb c = clipped_to_rec709({values[i], values[i + 1], values[i + 2]}, p->colour_space);
        values[i] = c.r, values[i + 1] = c.g, values[i + 2] = c.b;
    }
    return values;
}

/// A grid of one number for each cell; null where the parameter is not given.
std::shared_ptr<const DensityGrid> uniform_grid(Entity& e, const CurrentTransform& space,
                                                std::string_view name) {
    const LatticePlace n = cells(e);
    const std::span<const float> values = cell_values(e, name, ParameterType::floats, n);
    if (values.empty()) return nullptr;
    return cell_grid(values, n, box_of(e), space.get(e.where).inverse(), e.where);
}

/// The offset that is subtracted from temperatures, which older files call a cutoff.
float temperature_offset(ParameterList& p) {
    return p.number("temperatureoffset", p.number("temperaturecutoff", 0));
}

/// Emission of a black body by its temperature in kelvin, (value - offset) * scale, none up to 100
/// as in pbrt.
Glow thermal_glow(std::shared_ptr<const DensityGrid> temperature, float offset, float scale,
                  float factor, Entity& e, BuildContext& context) {
    constexpr int kTemperatures = 1024;
    constexpr float kDark = 100;
    Glow glow{std::move(temperature), std::vector<Rgb>(kTemperatures)};
    const float step = glow.field->largest() / (kTemperatures - 1);
    for (int i = 0; i < kTemperatures; ++i) {
        const float kelvin = (float(i) * step - offset) * scale;
        if (kelvin > kDark && std::isfinite(kelvin))
            glow.radiance[size_t(i)] = scaled_light(
                blackbody_colour(double(kelvin), context) * blackbody_luminance(double(kelvin)),
                factor, e.where, context);
    }
    return glow;
}

/// The radiance that each cell of a grid adds per unit of length, by its channels; null where all
/// are dark.
std::shared_ptr<const EmissionField> emission_field(std::span<const float> values, Entity& e,
                                                    const CurrentTransform& space) {
    if (std::ranges::all_of(values, [](float v) { return v == 0; })) return nullptr;
    const LatticePlace n = cells(e);
    const Bounds3 box = box_of(e);
    std::vector<float> whole(values.size() / 3), part(values.size() / 3);
    const auto grid = [&](const std::vector<float>& cells) {
        return cell_grid(cells, n, box, space.get(e.where).inverse(), e.where);
    };
    EmissionField field;
    for (size_t c = 0; c < 3; ++c) {
        for (size_t i = 0; i < part.size(); ++i) whole[i] += part[i] = values[3 * i + c];
        field.channels[c] = grid(part);
    }
    field.whole = grid(whole);
    return std::make_shared<const EmissionField>(std::move(field));
}

void uniform_medium(MediumDescription& medium, Entity& e, const CurrentTransform& space,
                    BuildContext& context) {
    ParameterList& p = e.parameters;
    coefficients(medium, e, context);
    medium.density = uniform_grid(e, space, "density");
    if (!medium.density)
        throw Error(
            ErrorKind::scene, e.where,
            "medium " + in_quotes(medium.name) + " has no grid; expected \"float density\"");
    // A parameter of our own
    medium.source = emission_field(cell_colours(e, "emission", cells(e)), e, space);
    auto temperature = uniform_grid(e, space, "temperature");
    if (temperature && p.has("Le"))
        e.refuse("Le", "medium " + in_quotes(medium.name) +
                           " has both \"Le\" and \"temperature\"; expected one of them");
    if (!temperature && !p.has("Le")) return;
    // One number, or one for each cell
    const Parameter* scales = p.find("Lescale", {ParameterType::floats});
    const bool is_even = !scales || scales->numbers.size() == 1;
    const float factor = is_even ? not_negative(e, "Lescale") : 1;
    auto scale = is_even ? nullptr : uniform_grid(e, space, "Lescale");
    const auto brightest = [&](Rgb light) {
        return scaled_light(light, scale->largest(), p.where("Lescale", e.where), context);
    };
    if (temperature) {
        Glow glow = thermal_glow(std::move(temperature), temperature_offset(p),
                                 p.number("temperaturescale", 1), factor, e, context);
        if (scale) std::ranges::for_each(glow.radiance, brightest);
        glow.factor = std::move(scale);
        medium.glow = std::make_shared<const Glow>(std::move(glow));
    } else {
        const Rgb light =
            scaled_light(light_colour(p, "Le", context), factor, p.where("Le", e.where), context);
        if (scale)
            medium.glow = std::make_shared<const Glow>(Glow{scale, {Rgb{}, brightest(light)}});
        else
            medium.emission = light;
    }
}

/// The emission of the cells of an "rgbgrid": the radiance Le of what absorbs there.
std::shared_ptr<const EmissionField> emission_of_absorption(std::span<const float> absorption,
                                                            float scale, Entity& e,
                                                            const CurrentTransform& space,
                                                            const BuildContext& context) {
    const std::vector<float> light = cell_colours(e, "Le", cells(e));
    const float factor = not_negative(e, "Lescale") * scale;
    if (light.empty()) return nullptr;
    if (absorption.empty())
        e.refuse("Le", "\"Le\" is the light of what absorbs; expected \"rgb sigma_a\" beside it");
    std::vector<float> values(light.size());
    for (size_t i = 0; i < values.size(); ++i)
        values[i] = scaled_light(Rgb{light[i] * absorption[i]}, factor,
                                 e.parameters.where("Le", e.where), context)
                        .r;
    return emission_field(values, e, space);
}

/// Makes a medium of the mean colour of its cells, as dense in each of them as its extinction is,
/// all channels together. What it emits has the colours of the cells.
void rgb_medium(MediumDescription& medium, Entity& e, const CurrentTransform& space,
                BuildContext& context) {
    const LatticePlace n = cells(e);
    const float scale = not_negative(e, "scale");
    const std::vector<float> absorption = cell_colours(e, "sigma_a", n),
                             scattering = cell_colours(e, "sigma_s", n);
    const size_t count = std::max(absorption.size(), scattering.size()) / 3;
    if (count == 0)
        throw Error(ErrorKind::scene, e.where,
                    "medium " + in_quotes(medium.name) +
                        " has no grid; expected \"rgb sigma_a\" or \"rgb sigma_s\"");
    std::vector<float> extinction(count);
    const auto add = [&](std::span<const float> values) {
        std::array<double, 3> sum{};
        for (size_t i = 0; i < 3 * count; ++i) {
            const float v = values.empty() ? 1 : values[i];
            sum[i % 3] += double(v);
            extinction[i / 3] += v;
        }
        const auto mean = [&](size_t c) { return float(sum[c] / double(count)); };
        return Rgb{mean(0), mean(1), mean(2)} * scale;
    };
    medium.sigma_a = add(absorption);
    medium.sigma_s = add(scattering);
    double mean = 0;
    for (float v : extinction) mean += double(v) / double(count);
    if (mean > 0)
        for (float& v : extinction) v /= float(mean);
    medium.density = cell_grid(extinction, n, box_of(e), space.get(e.where).inverse(), e.where);
    medium.source = emission_of_absorption(absorption, scale, e, space, context);
    context.log.add(e.where, "medium " + in_quotes(medium.name) +
                                 ": what grids of type \"rgbgrid\" scatter and absorb has one "
                                 "colour, the mean of their cells'; how dense they are varies");
}

void cloud_medium(MediumDescription& medium, Entity& e, const CurrentTransform& space,
                  BuildContext& context) {
    coefficients(medium, e, context);
    Cloud cloud{box_of(e), not_negative(e, "density"), e.parameters.number("wispiness", 1),
                e.positive("frequency", 5)};
    medium.density = std::make_shared<const DensityGrid>(
        cloud_grid(cloud, space.get(e.where).inverse(), e.where));
}

void nanovdb_medium(MediumDescription& medium, Entity& e, const CurrentTransform& space,
                    BuildContext& context) {
    ParameterList& p = e.parameters;
    coefficients(medium, e, context);
    const std::string name = p.text("filename");
    if (name.empty())
        throw Error(
            ErrorKind::scene, e.where,
            "medium " + in_quotes(medium.name) + " has no file; expected \"string filename\"");
    const SourceLocation where = p.where("filename", e.where);
    const std::filesystem::path file = context.files.find(name, where);
    const std::string bytes = context.files.read(file, where);
    const Transform medium_from_world = space.get(e.where).inverse();
    const SourceLocation in_file{std::make_shared<const std::string>(file.string()), 0, 0};
    medium.density = read_nanovdb(bytes, "density", medium_from_world, in_file);
    if (!medium.density)
        throw Error(ErrorKind::scene, in_file, "there is no grid \"density\" in the file");
    const float factor = p.number("LeScale", not_negative(e, "Lescale"));
    if (auto temperature = read_nanovdb(bytes, "temperature", medium_from_world, in_file);
        temperature && factor > 0)
        medium.glow = std::make_shared<const Glow>(
            thermal_glow(std::move(temperature), temperature_offset(p),
                         p.number("temperaturescale", 1), factor, e, context));
}

}  // namespace

MediumDescription build_medium(std::string name, Entity& e, const CurrentTransform& space,
                               BuildContext& context) {
    MediumDescription medium;
    medium.name = std::move(name);
    medium.where = e.where;
    const std::string label = "medium " + in_quotes(medium.name);
    const std::string type = e.parameters.text("type");
    if (type.empty())
        throw Error(ErrorKind::scene, e.where, label + " has no type; expected \"string type\"");
    medium.g = mean_cosine(e);
    medium.is_seen = !e.parameters.flag("hiddenfromcamera", false);
    if (type == "homogeneous") {
        homogeneous(medium, e, context);
    } else if (type == "uniformgrid") {
        uniform_medium(medium, e, space, context);
    } else if (type == "rgbgrid") {
        rgb_medium(medium, e, space, context);
    } else if (type == "cloud") {
        cloud_medium(medium, e, space, context);
    } else if (type == "nanovdb") {
        nanovdb_medium(medium, e, space, context);
    } else {
        throw unknown_type_error(e.parameters.where("type", e.where), "medium", type,
                                 {"homogeneous", "uniformgrid", "rgbgrid", "cloud", "nanovdb"});
    }
    e.parameters.warn_unused(context.log, "media of type " + in_quotes(type));
    return medium;
}

}  // namespace covtrace
