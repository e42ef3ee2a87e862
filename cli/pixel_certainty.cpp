#include "cli/pixel_certainty.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "cli/pixel_description.h"
namespace covtrace::cli {

namespace {

constexpr double kFloor = 0.01;  ///< constant in the denominator of relMSE
/// The deviation of single samples over their mean from which paths are called rare: 16 samples
/// leave all of the pixel's light uncertain then.
constexpr double kRare = 4;
/// Periods across aperture or shutter from which they are called the cause: less than a quarter
/// changes no more than half of a wave.
constexpr double kSpread = 0.25;

double square(double v) {
    return v * v;
}

/// Calls visit(i) for the 5x5 pixels around the one with this index.
template <typename Visit>
void for_around(const Image& image, size_t index, const Visit& visit) {
    constexpr int kReach = 2;
    const int w = image.width(), h = image.height();
    const int x = int(index % size_t(w)), y = int(index / size_t(w));
    for (int v = std::max(0, y - kReach); v <= std::min(h - 1, y + kReach); ++v)
        for (int u = std::max(0, x - kReach); u <= std::min(w - 1, x + kReach); ++u)
            visit(size_t(v) * size_t(w) + size_t(u));
}

/// The deviation of single samples over their mean, of the pixels around; 0 without the layers raw,
/// variance and samples. A pixel alone seldom knows: the rare path is beside it.
double sample_deviation(const Image& image, size_t index) {
    std::array<const Channel*, 3> raw{}, variance{};
    const Channel* samples = image.find("samples.Y");
    for (size_t c = 0; c < 3; ++c) {
        const std::string name(1, "RGB"[c]);
        raw[c] = image.find("raw." + name);
        variance[c] = image.find("variance." + name);
        if (!samples || !raw[c] || !variance[c]) return 0;
    }
    const auto luminance_of = [](const auto& value) {
        return 0.2126 * value(0) + 0.7152 * value(1) + 0.0722 * value(2);
    };
    double mean = 0, squares = 0;
    int known = 0;
    for_around(image, index, [&](size_t i) {
        const double n = samples->values[i];
        const double deviation = luminance_of(
            [&](size_t c) { return std::sqrt(std::max(0.0, double(variance[c]->values[i]))); });
        const double light = luminance_of([&](size_t c) { return raw[c]->values[i]; });
        if (n < 2 || !std::isfinite(deviation) || !std::isfinite(light)) return;
        mean += light;
        squares += n * square(deviation);
        ++known;
    });
    return known > 0 && mean > 0 ? std::sqrt(squares / known) / (mean / known) : 0;
}

/// Deviation of the spectrum along an axis, from the covariances of the pixels around by their
/// weights: the analysis leaves most pixels without a path of their own.
double bandwidth(const Image& image, size_t index, int axis) {
    const Channel *c = image.find(fmt::format("cov.{0}{0}", axis)),
                  *weight = image.find("covweight.Y");
    if (!c || !weight) return 0;
    double sum = 0, weights = 0;
    for_around(image, index, [&](size_t i) {
        sum += double(weight->values[i]) * c->values[i];
        weights += weight->values[i];
    });
    return weights > 0 && sum > 0 ? std::sqrt(sum / weights) : 0;
}

/// The cause of a pixel's noise, in words that a colon follows; empty where no layer tells one.
std::string cause(const Image& image, size_t index) {
    const double deviation = sample_deviation(image, index);
    if (deviation > kRare)
        return fmt::format("rare paths (single samples vary by {} times their mean): ",
                           format_number(std::round(deviation)));
    // The aperture is two of the radii wide that the covariance counts in.
    const double lens = 2 * std::max(bandwidth(image, index, 2), bandwidth(image, index, 3)),
                 shutter = bandwidth(image, index, 4);
    if (std::max(lens, shutter) < kSpread) return {};
    return lens >= shutter ? "out of focus: " : "in motion: ";
}

/// An error in per cent, with two digits that count.
std::string percent(double relative) {
    const double value = 100 * relative;
    if (value < 0.1) return "below 0.1 %";
    return fmt::format("{:.{}f} %", value, value < 9.95 ? 1 : 0);
}

}  // namespace

std::optional<double> relative_error(const Image& image, size_t index) {
    const Channel* error = image.find("error.Y");
    if (!error || !image.find("R") || !image.find("G") || !image.find("B")) return std::nullopt;
    const double r =
        error->values[index] / std::sqrt(square(double(luminance(image.rgb(index)))) + kFloor);
    return std::isfinite(r) ? r : 0;
}

std::optional<double> image_error(const Image& image) {
    double sum = 0;
    for (size_t i = 0; i < image.pixel_count(); ++i) {
        const auto r = relative_error(image, i);
        if (!r) return std::nullopt;
        sum += square(*r);
    }
    return std::sqrt(sum / double(image.pixel_count()));
}

std::optional<PixelCertainty> pixel_certainty(const Image& image, size_t index, double whole) {
    const auto relative = relative_error(image, index);
    if (!relative) return std::nullopt;
    PixelCertainty p{*relative, 1, {}};
    if (whole > 0) p.samples_factor = std::max(1.0, square(p.relative_error / whole));
    const Channel* samples = image.find("samples.Y");
    if (samples && samples->values[index] == 0) {
        p.sentence = "no sample was taken here: what is shown comes from the pixels around";
        return p;
    }
    p.sentence = cause(image, index) + "error " + percent(p.relative_error);
    if (p.relative_error <= whole)
        p.sentence += fmt::format(", no more than the image's {}", percent(whole));
    else
        p.sentence += fmt::format(
            ", about {} times the samples would bring it to the image's {}",
            format_number(p.samples_factor < 9.95 ? std::round(10 * p.samples_factor) / 10
                                                  : std::round(p.samples_factor)),
            percent(whole));
    return p;
}

}  // namespace covtrace::cli
