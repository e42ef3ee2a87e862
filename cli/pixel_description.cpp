#include "cli/pixel_description.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "covariance/covariance.hpp"

namespace covtrace::cli {

namespace {

/// An axis of the covariance, as it is shown.
struct Axis {
    const char *name, *unit;
    double scale;  ///< factor from the covariance's unit to `unit`
};
constexpr std::array<Axis, 5> kAxes{Axis{"image x", "cycles/pixel", 1},
                                    {"image y", "cycles/pixel", 1},
                                    {"lens x", "cycles/aperture", 2},
                                    {"lens y", "cycles/aperture", 2},
                                    {"time", "cycles/shutter", 1}};

/// The kinds of candidates, as channels of the layer `share` and for people.
constexpr std::array<std::array<const char*, 2>, 4> kCandidateKinds{
    {{"denoiser", "the denoiser"},
     {"regression", "regressions"},
     {"gaussian", "predicted Gaussians"},
     {"raw", "the samples alone"}}};

/// The value of a channel at an index of its pixels.
std::optional<float> find_value(const Image& image, const std::string& channel, size_t index) {
    const Channel* c = image.find(channel);
    return c ? std::optional(c->values[index]) : std::nullopt;
}

/// Principal axes of the 2x2 matrix in a layer's channels xx, xy and yy; empty without them.
std::optional<PrincipalAxes> find_axes(const Image& image, const std::string& layer, size_t i) {
    const auto xx = find_value(image, layer + ".xx", i), xy = find_value(image, layer + ".xy", i),
               yy = find_value(image, layer + ".yy", i);
    if (!xx || !xy || !yy) return std::nullopt;
    return principal_axes(*xx, *xy, *yy);
}

/// The matrix in the channels cov.00, cov.01 ... cov.44; empty unless all 15 are there.
std::optional<std::array<std::array<float, 5>, 5>> find_covariance(const Image& image, size_t i) {
    std::array<std::array<float, 5>, 5> matrix{};
    for (size_t r = 0; r < 5; ++r)
        for (size_t c = r; c < 5; ++c) {
            const auto entry = find_value(image, fmt::format("cov.{}{}", r, c), i);
            if (!entry) return std::nullopt;
            matrix[r][c] = matrix[c][r] = *entry;
        }
    return matrix;
}

/// The bandwidth in words, the same ones as bandwidthWords has in viewer/page/covariance.js. `axis`
/// is an index into kAxes, `value` is in its unit.
std::string bandwidth_words(size_t axis, double value) {
    // Cycles over the whole aperture or shutter below which nothing varies: such a part of a wave
    // changes by less than 2 pi 0.05, a third of its amplitude.
    constexpr double kStill = 0.05;
    if (axis < 2) {
        if (value < 0.001) return "does not vary";
        // Pixels show no more than half a cycle each (Nyquist).
        if (value >= 0.5) return "finer than the pixels can show (0.5)";
        return "one period in " + format_number(1 / value) + " pixels";
    }
    const std::string where = axis < 4 ? "across the aperture" : "while the shutter is open";
    if (value < kStill) return (axis < 4 ? "in focus: constant " : "at rest: constant ") + where;
    return format_number(value) + " periods " + where;
}

/// The count N that the pixel's own covariance asks for; a render's plan smooths covariances and
/// limits counts. k is that of the image's metadata, covtrace:k.
HypercubeCount hypercube_count(const Image& image,
                               const std::array<std::array<float, 5>, 5>& covariance) {
    covariance::SymmetricMatrix5<double> sigma;
    for (size_t r = 0; r < 5; ++r)
        for (size_t c = r; c < 5; ++c) sigma(r, c) = covariance[r][c];
    const auto [spectrum, integration] = covariance::integrate_over_sensor(sigma);
    HypercubeCount count{covariance::hypercube_density(spectrum, integration), {}};
    if (const auto k = image.metadata.find("covtrace:k"); k != image.metadata.end())
        if (const float* value = std::get_if<float>(&k->second)) count.k = *value;
    return count;
}

/// A number of JSON, which knows neither infinity nor NaN.
nlohmann::json number_or_null(double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

nlohmann::json to_json(const std::optional<PrincipalAxes>& axes, const char* unit) {
    if (!axes) return {};
    return {{"major", axes->major},
            {"minor", axes->minor},
            {"angle_degrees", axes->angle},
            {"unit", unit}};
}

}  // namespace

std::string format_number(double value) {
    if (!std::isfinite(value)) return std::isnan(value) ? "NaN" : (value > 0 ? "inf" : "-inf");
    if (value == 0) return "0";  // also for -0
    const double size = std::abs(value);
    const std::string scientific = fmt::format("{:.3e}", value);
    if (size >= 1e5 || size < 1e-4) return scientific;
    return fmt::format("{}", std::strtod(scientific.c_str(), nullptr));
}

PrincipalAxes principal_axes(double xx, double xy, double yy) {
    constexpr double kDegrees = 57.29577951308232;
    const double mean = (xx + yy) / 2, radius = std::hypot((xx - yy) / 2, xy);
    double angle = radius > 0 ? -std::atan2(xy, (xx - yy) / 2) / 2 * kDegrees : 0;
    if (angle <= -90) angle += 180;
    return {std::sqrt(std::max(0.0, mean + radius)), std::sqrt(std::max(0.0, mean - radius)),
            angle + 0.0};  // no -0
}

PixelDescription describe_pixel(const Image& image, int x, int y) {
    const PixelBounds& d = image.data;
    if (x < d.x0 || x >= d.x1 || y < d.y0 || y >= d.y1)
        throw Error(ErrorKind::usage,
                    fmt::format("--pixel: {},{} is outside the image, which has x from {} to {} "
                                "and y from {} to {}",
                                x, y, d.x0, d.x1 - 1, d.y0, d.y1 - 1));
    const size_t i = size_t(y - d.y0) * size_t(image.width()) + size_t(x - d.x0);
    PixelDescription p;
    p.x = x;
    p.y = y;
    p.covariance = find_covariance(image, i);
    for (const Channel& c : image.channels)
        if (!p.covariance || !c.name.starts_with("cov."))
            p.values.emplace_back(c.name, c.values[i]);
    if (p.covariance)
        for (size_t k = 0; k < 5; ++k) {
            const double value =
                kAxes[k].scale * std::sqrt(std::max(0.0, double((*p.covariance)[k][k])));
            p.bandwidth.push_back({kAxes[k].name, kAxes[k].unit, value, bandwidth_words(k, value)});
        }
    if (p.covariance) p.hypercube = hypercube_count(image, *p.covariance);
    p.found_light = find_value(image, "covweight.Y", i).value_or(1) != 0;
    p.spectrum = find_axes(image, "spectrum", i);
    p.filter = find_axes(image, "filter", i);
    p.samples = find_value(image, "samples.Y", i);
    p.density = find_value(image, "density.Y", i);
    p.error = find_value(image, "error.Y", i);
    p.certainty = pixel_certainty(image, i, image_error(image).value_or(0));
    for (const auto& [kind, title] : kCandidateKinds)
        if (const auto share = find_value(image, "share." + std::string(kind), i))
            p.shares.push_back({kind, title, *share});
    return p;
}

std::string to_text(const PixelDescription& p) {
    std::string text = fmt::format("pixel {},{}\n", p.x, p.y);
    for (const auto& [name, value] : p.values)
        text += fmt::format("  {:<14} {}\n", name, format_number(value));
    if (p.samples) text += "samples: " + format_number(*p.samples) + " taken";
    if (p.samples && p.density) text += ", " + format_number(*p.density) + " predicted";
    if (p.samples) text += "\n";
    if (p.certainty) text += p.certainty->sentence + "\n";
    if (p.error) text += "estimated standard error: " + format_number(*p.error) + "\n";
    if (!p.shares.empty()) {
        text += "made of";
        for (const CandidateShare& s : p.shares)
            text += fmt::format("{}{:.0f} % {}", &s == &p.shares[0] ? ": " : ", ", 100 * s.share,
                                s.title);
        text += "\n";
    }
    if (p.filter)
        text += fmt::format(
            "filter: a Gaussian of {} by {} pixels (standard deviations), its long axis at {}°\n",
            format_number(p.filter->major), format_number(p.filter->minor),
            format_number(std::round(p.filter->angle * 10) / 10));
    if (!p.covariance) return text;
    if (!p.found_light)
        return text +
               "no path of the analysis found light here: the prediction comes from the "
               "neighbours\n";
    text += "how fast the light varies (standard deviation of its spectrum)\n";
    for (const AxisBandwidth& b : p.bandwidth)
        text += fmt::format("  {:<8} {:>10} {:<16} {}\n", b.name, format_number(b.value), b.unit,
                            b.words);
    if (p.spectrum)
        text += fmt::format(
            "integrated over lens and shutter: up to {} cycles/pixel at {}°, {} across\n",
            format_number(p.spectrum->major),
            format_number(std::round(p.spectrum->angle * 10) / 10),
            format_number(p.spectrum->minor));
    if (p.hypercube) {
        text += "samples per unit hypercube (pixel, whole aperture, shutter): pi sqrt|S + W| = " +
                format_number(p.hypercube->density);
        if (p.hypercube->k)
            text += ", times k = " + format_number(*p.hypercube->k) + ": " +
                    format_number(p.hypercube->density * *p.hypercube->k);
        text += "\n";
    }
    text +=
        "covariance of the spectrum (products of cycles per pixel, per aperture radius, per "
        "shutter)\n          ";
    for (const Axis& axis : kAxes) text += fmt::format("{:>12}", axis.name);
    for (size_t r = 0; r < 5; ++r) {
        text += fmt::format("\n  {:<8}", kAxes[r].name);
        for (size_t c = 0; c < 5; ++c)
            text += fmt::format("{:>12}", format_number((*p.covariance)[r][c]));
    }
    return text + "\n";
}

nlohmann::json to_json(const PixelDescription& p) {
    nlohmann::json values = nlohmann::json::object();
    for (const auto& [name, value] : p.values) values[name] = number_or_null(value);
    nlohmann::json j{{"x", p.x}, {"y", p.y}, {"values", std::move(values)}};
    if (p.samples) j["samples"] = number_or_null(*p.samples);
    if (p.density) j["density"] = number_or_null(*p.density);
    if (p.error) j["error"] = number_or_null(*p.error);
    if (p.certainty) {
        j["relative_error"] = number_or_null(p.certainty->relative_error);
        j["samples_factor"] = number_or_null(p.certainty->samples_factor);
        j["sentence"] = p.certainty->sentence;
    }
    for (const CandidateShare& s : p.shares) j["shares"][s.kind] = number_or_null(s.share);
    if (p.filter) j["filter"] = to_json(p.filter, "pixels");
    if (p.spectrum) j["spectrum"] = to_json(p.spectrum, "cycles/pixel");
    if (!p.covariance) return j;
    j["covariance"] = *p.covariance;
    j["covariance_units"] = {"cycles/pixel", "cycles/pixel", "cycles/aperture radius",
                             "cycles/aperture radius", "cycles/shutter"};
    j["hypercube"] = {{"density", number_or_null(p.hypercube->density)}};
    if (p.hypercube->k) {
        j["hypercube"]["k"] = *p.hypercube->k;
        j["hypercube"]["samples"] = number_or_null(p.hypercube->density * *p.hypercube->k);
    }
    j["found_light"] = p.found_light;
    for (const AxisBandwidth& b : p.bandwidth)
        j["bandwidth"].push_back(
            {{"axis", b.name}, {"value", b.value}, {"unit", b.unit}, {"words", b.words}});
    return j;
}

}  // namespace covtrace::cli
