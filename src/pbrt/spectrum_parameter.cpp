#include "pbrt/spectrum_parameter.h"

#include <algorithm>

#include "colour/named_spectra.h"
#include "colour/sigmoid_spectrum.h"
#include "pbrt/token_stream.h"
#include "pbrt/tokenizer.h"
#include "scene/imaging_scale.h"
#include "scene/names.h"

namespace covtrace {

namespace {

Spectrum from_pairs(const std::vector<float>& numbers, const SourceLocation& where,
                    BuildContext& context) {
    if (numbers.empty() || numbers.size() % 2 != 0)
        throw Error(ErrorKind::scene, where,
                    "a spectrum has " + std::to_string(numbers.size()) +
                        " values; expected pairs of wavelength and value");
    Spectrum s;
    int negative = 0;
    for (size_t i = 0; i < numbers.size(); i += 2) {
        if (i > 0 && !(numbers[i] > numbers[i - 2]))
            throw Error(ErrorKind::scene, where,
                        "the wavelengths of a spectrum must increase; entry " +
                            std::to_string(i / 2 + 1) + " does not");
        s.wavelengths.push_back(numbers[i]);
        s.values.push_back(std::max(0.0f, numbers[i + 1]));
        negative += numbers[i + 1] < 0;
    }
    // Negative values are cut to 0: measured reflectances have such values where they are all but
    // nothing.
    if (negative > 0) context.log.add(where, "negative values of a spectrum are set to 0");
    return s;
}

/// Reads a spectrum from a text file of wavelength and value pairs, with "#" comments.
Spectrum from_file(const std::string& name, const SourceLocation& where, BuildContext& context) {
    const std::filesystem::path file = context.files.find(name, where);
    const std::string text = context.files.read(file, where);
    const auto shared_name = std::make_shared<const std::string>(file.string());
    Tokenizer tokens(text, shared_name);
    std::vector<float> numbers;
    for (Token t = tokens.next(); t.kind != Token::Kind::end; t = tokens.next())
        numbers.push_back(parse_float(t));
    return from_pairs(numbers, {shared_name, 0, 0}, context);
}

constexpr double kHeliumLine = 587.6;
// The squares of their squares must be numbers, and those of their inverses
constexpr float kSmallestIndex = 1e-6f, kLargestIndex = 1e6f;

/// The index at a wavelength in nanometres; 1 where there is none, as in pbrt.
float index_at(const Spectrum& index, float wavelength) {
    const auto n = static_cast<float>(index.at(double(wavelength)));
    return std::clamp(n > 0 ? n : 1, kSmallestIndex, kLargestIndex);
}

}  // namespace

std::optional<Spectrum> spectrum_value(const Parameter& p, BuildContext& context) {
    if (p.type == ParameterType::blackbody) {
        // A second number is the scale of version 3, which exporters still write and pbrt-v4 passes
        // over.
        if (p.numbers.size() == 2)
            context.log.add(p.where, "the second number of blackbody " + in_quotes(p.name) +
                                         ", a scale in pbrt-v3, is ignored");
        if (p.numbers.empty() || p.numbers.size() > 2 || !(p.numbers[0] > 0))
            throw Error(
                ErrorKind::scene, p.where,
                "parameter " + in_quotes(p.name) + " expects one temperature > 0 in kelvin");
        return blackbody_spectrum(p.numbers[0]);
    }
    if (p.strings.empty()) return from_pairs(p.numbers, p.where, context);
    if (p.strings.size() != 1)
        throw Error(ErrorKind::scene, p.where,
                    "parameter " + in_quotes(p.name) + " expects one spectrum");
    const std::string& name = p.strings[0];
    if (illuminant_colour(name)) return std::nullopt;
    if (auto known = material_spectrum(name)) return known;
    const bool looks_like_file = name.find_first_of("./\\") != std::string::npos;
    if (!looks_like_file)
        throw Error(ErrorKind::scene, p.where,
                    "unknown spectrum " + in_quotes(name) + "; expected a file or a name such as " +
                        "metal-Cu-eta, glass-BK7, stdillum-D65" +
                        did_you_mean(name, spectrum_names()));
    return from_file(name, p.where, context);
}

Rgb factor_colour(const Parameter& p, BuildContext& context) {
    if (p.type == ParameterType::rgb) return rgb_value(p);
    const std::optional<Spectrum> s = spectrum_value(p, context);
    if (!s) {
        context.log.add(p.where,
                        "the colour of light " + in_quotes(p.strings[0]) + " is used as a factor");
        return *illuminant_colour(p.strings[0]);
    }
    const Rgb c = reflectance_colour(*s);
    return {std::max(0.0f, c.r), std::max(0.0f, c.g), std::max(0.0f, c.b)};
}

Rgb blackbody_colour(double kelvin, const BuildContext& context) {
    return context.sensor ? context.sensor->blackbody_colour(kelvin)
                          : emission_colour(blackbody_spectrum(kelvin));
}

Rgb light_colour(ParameterList& parameters, std::string_view name, BuildContext& context) {
    const Parameter* p = parameters.find(
        name, {ParameterType::rgb, ParameterType::spectrum, ParameterType::blackbody});
    if (!p) return Rgb{1};
    if (p->type == ParameterType::rgb) return rgb_value(*p);
    const std::optional<Spectrum> s = spectrum_value(*p, context);
    if (!s) return *illuminant_colour(p->strings[0]);
    const Rgb c = p->type == ParameterType::blackbody
                      ? blackbody_colour(double(p->numbers[0]), context)
                      : emission_colour(*s);
    if (is_black(c) &&
        std::any_of(s->values.begin(), s->values.end(), [](float v) { return v > 0; }))
        context.log.add(p->where, "the spectrum " + in_quotes(p->name) +
                                      " has no visible light; the light is black");
    return c;
}

Rgb scaled_light(Rgb light, float factor, const SourceLocation& where,
                 const BuildContext& context) {
    const Rgb scaled = light * factor;
    if (!is_finite(scaled))
        throw Error(ErrorKind::scene, where,
                    "the light is too bright; expected a product of its colour and factors that "
                    "single precision holds, less than 3.4e38");
    if (!is_finite(scaled * imaging_scale(context.scene)))
        throw Error(ErrorKind::scene, where,
                    "the light is too bright for the film; expected a product with the film's iso "
                    "and the shutter's time that single precision holds, less than 3.4e38");
    return scaled;
}

RefractiveIndex refractive_index(ParameterList& parameters, std::string_view name, float otherwise,
                                 BuildContext& context) {
    const Parameter* p =
        parameters.find(name, {ParameterType::floats, ParameterType::spectrum, ParameterType::rgb});
    if (!p) return {otherwise, {}};
    std::optional<Spectrum> varying;
    float eta = 0;
    if (p->type == ParameterType::floats) {
        eta = p->numbers[0];
    } else if (p->type == ParameterType::rgb) {
        const Rgb c = rgb_value(*p);
        eta = c.g;
        if ((c.r != c.g || c.g != c.b) && max_component(c) > 0) varying = unbounded_spectrum(c);
    } else {
        varying = spectrum_value(*p, context);
        if (!varying)
            throw Error(ErrorKind::scene, p->where,
                        in_quotes(p->strings[0]) + " is a light; expected an index of refraction");
    }
    if (varying) {
        varying->extends = true;
        eta = static_cast<float>(varying->at(kHeliumLine));
    }
    if (!(eta > 0))
        throw Error(ErrorKind::scene, p->where,
                    "parameter " + in_quotes(p->name) + " must be greater than 0");
    if (eta > kLargestIndex)
        throw Error(ErrorKind::scene, p->where,
                    "parameter " + in_quotes(p->name) + " is too large; expected at most 1e6");
    if (eta < kSmallestIndex)
        throw Error(ErrorKind::scene, p->where,
                    "parameter " + in_quotes(p->name) + " is too small; expected at least 1e-6");
    if (!varying) return {eta, nullptr};
    return {eta, dispersion_of([&](float w) { return index_at(*varying, w); }, eta)};
}

float constant_index(ParameterList& parameters, std::string_view name, float otherwise,
                     BuildContext& context) {
    const RefractiveIndex index = refractive_index(parameters, name, otherwise, context);
    if (index.dispersion)
        context.log.add(parameters.where(name, {}),
                        "dispersion of coats and panes is not rendered; parameter " +
                            in_quotes(name) + " has its value at 587.6 nm");
    return index.eta;
}

}  // namespace covtrace
