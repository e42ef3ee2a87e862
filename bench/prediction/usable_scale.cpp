/// The usable scale of each pixel's predicted filter: how far it may be widened without changing
/// the pixel. A measure of how good the prediction is.
///
///     usable_scale [--no-neighbours] [--map MAP.png] IMAGE.exr PIXELS.exr CONVERGED.exr ...
///
/// IMAGE is by `render --method covariance --spp 16` with the layers that predicted_image.h names,
/// of which only the prediction is used. PIXELS is written by converged_pixels and holds the pixels
/// that are measured. CONVERGED are images by `--method uniform --layers variance,inview` with
/// different seeds; the filters find their mean around those pixels. The filter of a pixel is the
/// renderer's at 16 samples per pixel: (4 pi^2 c^2 Sigma_2D)^-1, c = 2, deviations in [0.5, 15]
/// pixels, limited by narrower neighbours unless --no-neighbours is given; emitters in view have
/// filters of their own. The usable scale of a pixel is the largest factor on the deviations up to
/// which all of these filters change the pixel's luminance Y by at most 2 % of Y + 0.01, in steps
/// of a quarter octave from 1/8 to 8. A perfect prediction has the same scale everywhere; one far
/// below the typical value blurs.
///
/// Noise that is left must not count as a change: the standard deviation of each change follows
/// from the variances of the images and of the pixel. Two results are printed: "change > 2 %" takes
/// the change as it is, so its scales are a little too small; "significant" asks for a change
/// beyond 2 % by two standard deviations, so its scales are a little too large. What no noise would
/// give lies in between. "noise removed" is that: at every scale the share of the pixels that
/// change by more than 2 %, of the distribution of changes that best explains all measured ones and
/// their noise (laboratory/deconvolution.h). It speaks of all pixels together, not of any one.
///
/// Prints a row of a Markdown table for each. MAP shows the converged image, the deviation of the
/// filter of the larger part of the light (fourth root of det S_h, pixels) and the usable scale
/// (significant), a measured pixel standing for its block; pixels with the narrowest filter are
/// greyed. docs/internals/prediction.md has results.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

#include "core/parallel.h"
#include "laboratory/deconvolution.h"
#include "reconstruction/filter_field.h"
#include "support/false_colour.h"
#include "support/predicted_image.h"

using namespace covtrace;

namespace {

constexpr float kTolerance = 0.02f, kFloor = 0.01f;
constexpr float kSignificant = 2;  // standard deviations
constexpr int kStepsPerOctave = 4;
constexpr int kFirstStep = -3 * kStepsPerOctave, kLastStep = 3 * kStepsPerOctave;

/// Colours, luminances of the two parts of the light, and the variance of their sum.
struct Converged {
    std::vector<Rgb> mean;
    std::vector<float> scattered, in_view, variance;
};

Converged read_converged(std::span<const char* const> files, const Image& like) {
    const size_t n = like.pixel_count();
    Converged c{std::vector<Rgb>(n), std::vector<float>(n), std::vector<float>(n),
                std::vector<float>(n)};
    for (const char* file : files) {
        const Image image = read_image(file);
        if (image.data != like.data)
            throw Error(ErrorKind::usage,
                        fmt::format("{}: has other pixels than the predicted image", file));
        for (size_t i = 0; i < n; ++i) {
            c.mean[i] += image.rgb(i) / float(files.size());
            c.in_view[i] += luminance(image.rgb(i, "inview.")) / float(files.size());
            const Rgb v = image.rgb(i, "variance.");
            c.variance[i] += sqr(luminance({std::sqrt(v.r), std::sqrt(v.g), std::sqrt(v.b)})) /
                             sqr(float(files.size()));
        }
    }
    for (size_t i = 0; i < n; ++i) c.scattered[i] = luminance(c.mean[i]) - c.in_view[i];
    return c;
}

struct MeasuredPixel {
    int x, y;
    float scattered, in_view;  ///< luminance
    float variance;            ///< of their sum
};

std::vector<MeasuredPixel> read_pixels(const char* file, const Image& like) {
    const Image image = read_image(file);
    const Channel *variance = image.find("variance.Y"), *samples = image.find("samples.Y");
    if (image.data != like.data || !variance || !samples)
        throw Error(ErrorKind::usage,
                    fmt::format("{}: expected what converged_pixels writes, of the same pixels as "
                                "the predicted image",
                                file));
    std::vector<MeasuredPixel> result;
    for (size_t i = 0; i < image.pixel_count(); ++i)
        if (samples->values[i] > 0) {
            const float in_view = luminance(image.rgb(i, "inview."));
            result.push_back({int(i % size_t(image.width())), int(i / size_t(image.width())),
                              luminance(image.rgb(i)) - in_view, in_view, variance->values[i]});
        }
    return result;
}

struct Change {
    float value = 0, noise = 0;  ///< of the luminance: change, and its standard deviation
};

/// The change of the pixel by the Gaussian with the covariance `s`, cut at 3 standard deviations as
/// the gather does.
Change change_by(const std::vector<float>& values, const std::vector<float>& variances, int width,
                 int height, const MeasuredPixel& p, float value,
                 const covariance::Sym2<float>& s) {
    const auto q = covariance::inverse(s);
    const int reach_x = int(3 * std::sqrt(s.xx)), reach_y = int(3 * std::sqrt(s.yy));
    double sum = 0, total = 1, squares = 0;
    for (int y = std::max(0, p.y - reach_y); y <= std::min(height - 1, p.y + reach_y); ++y)
        for (int x = std::max(0, p.x - reach_x); x <= std::min(width - 1, p.x + reach_x); ++x) {
            const auto dx = float(x - p.x), dy = float(y - p.y);
            const float e = q.xx * dx * dx + 2 * q.xy * dx * dy + q.yy * dy * dy;
            if (e > 9 || (x == p.x && y == p.y)) continue;
            const double h = std::exp(-0.5f * e);
            const size_t i = size_t(y) * size_t(width) + size_t(x);
            sum += h * (double(values[i]) - double(value));
            squares += h * h * double(variances[i]);
            total += h;
        }
    const double own = (total - 1) / total;
    return {float(sum / total),
            float(std::sqrt(squares / (total * total) + own * own * double(p.variance)))};
}

struct UsableScales {
    std::vector<float> plain, significant;  ///< 0: not even the smallest
    std::vector<float> noise;               ///< of the change at scale 1, over luminance + 0.01
    /// Share of the pixels whose usable scale is below each of the steps, without noise.
    std::vector<double> below;
};

float scale_of(int step) {
    return std::exp2(float(step) / kStepsPerOctave);
}

/// `in_view`: the filters of emitters in view. Their light has hardly any noise: all of the
/// variance is put down to scattered light.
UsableScales usable_scales(const FilterField& field, const FilterField& in_view,
                           const Converged& image, const std::vector<MeasuredPixel>& pixels) {
    UsableScales r{std::vector<float>(pixels.size()),
                   std::vector<float>(pixels.size()),
                   std::vector<float>(pixels.size()),
                   {}};
    constexpr size_t kSteps = kLastStep - kFirstStep + 1;
    std::vector<std::vector<float>> changes(kSteps, std::vector<float>(pixels.size())),
        deviations = changes;
    parallel_for(int64_t(pixels.size()), [&](int64_t k) {
        const MeasuredPixel& p = pixels[size_t(k)];
        const size_t i = size_t(p.y) * size_t(field.width) + size_t(p.x);
        const float scale = p.scattered + p.in_view + kFloor;
        bool plain = true, significant = true;
        for (int step = kFirstStep; step <= kLastStep; ++step) {
            const float s = scale_of(step);
            Change c = change_by(image.scattered, image.variance, field.width, field.height, p,
                                 p.scattered, s * s * field.covariance[i]);
            c.value += change_by(image.in_view, image.variance, field.width, field.height, p,
                                 p.in_view, s * s * in_view.covariance[i])
                           .value;
            if (step == 0) r.noise[size_t(k)] = c.noise / scale;
            changes[size_t(step - kFirstStep)][size_t(k)] = c.value / (kTolerance * scale);
            deviations[size_t(step - kFirstStep)][size_t(k)] = c.noise / (kTolerance * scale);
            plain = plain && std::abs(c.value) <= kTolerance * scale;
            significant =
                significant && std::abs(c.value) <= kTolerance * scale + kSignificant * c.noise;
            if (plain) r.plain[size_t(k)] = s;
            if (significant) r.significant[size_t(k)] = s;
        }
    });
    // A pixel's usable scale ends where its change first is too large.
    for (size_t step = 0; step < kSteps; ++step)
        r.below.push_back(std::max(r.below.empty() ? 0.0 : r.below.back(),
                                   share_beyond(changes[step], deviations[step])));
    return r;
}

/// quantile(p); shares below 0.35, above 6 and at the narrowest filter; noise.
template <typename Quantile>
void print_row(std::string_view name, const Quantile& quantile, double low, double high,
               double narrowest, double noise) {
    fmt::print(
        "| {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.1f} % | {:.1f} % | {:.1f} % | "
        "{:.2f} % |\n",
        name, quantile(0.05), quantile(0.25), quantile(0.5), quantile(0.75), quantile(0.95),
        100 * low, 100 * high, 100 * narrowest, 100 * noise);
}

void print_row(std::string_view name, std::vector<float> scales, float narrowest, float noise) {
    std::sort(scales.begin(), scales.end());
    const auto share = [&](auto&& predicate) {
        return double(std::count_if(scales.begin(), scales.end(), predicate)) /
               double(scales.size());
    };
    print_row(
        name, [&](double p) { return scales[size_t(p * double(scales.size() - 1))]; },
        share([](float s) { return s < 0.35f; }), share([](float s) { return s > 6; }), narrowest,
        noise);
}

/// `below`: the share of the pixels that are below each step.
void print_row(std::string_view name, const std::vector<double>& below, float narrowest,
               float noise) {
    // The largest scale at which no more than the share p is below.
    const auto quantile = [&](double p) {
        float s = 0;
        for (size_t i = 0; i < below.size() && below[i] <= p; ++i)
            s = scale_of(kFirstStep + int(i));
        return s;
    };
    // Not usable at the largest step below 0.35; usable at the smallest step above 6.
    const auto at = [&](float s) {
        size_t i = 0;
        while (i + 1 < below.size() && scale_of(kFirstStep + int(i)) < s) ++i;
        return i;
    };
    print_row(name, quantile, below[at(0.35f)], 1 - below[at(6)], narrowest, noise);
}

/// The filter of the part that holds more of a pixel's light.
const covariance::Sym2<float>& main_filter(const FilterField& field, const FilterField& in_view,
                                           const Converged& image, size_t i) {
    return image.in_view[i] > image.scattered[i] ? in_view.covariance[i] : field.covariance[i];
}

/// Index of the measured pixel nearest to a pixel.
size_t nearest(const std::vector<MeasuredPixel>& pixels, int x, int y) {
    const auto squared = [&](const MeasuredPixel& p) {
        return (p.x - x) * (p.x - x) + (p.y - y) * (p.y - y);
    };
    return size_t(
        std::min_element(pixels.begin(), pixels.end(),
                         [&](const auto& a, const auto& b) { return squared(a) < squared(b); }) -
        pixels.begin());
}

void write_map(const char* file, const FilterField& field, const FilterField& in_view,
               const Converged& image, const std::vector<MeasuredPixel>& pixels,
               const std::vector<float>& scales, const std::vector<bool>& narrowest) {
    const LogColours sizes{{{0.5f, {0, 0, 0.1f}},
                            {1, {0.05f, 0, 0.5f}},
                            {2, {0.6f, 0.02f, 0.3f}},
                            {5, {1, 0.35f, 0.02f}},
                            {15, {1, 1, 0.6f}}}};
    const LogColours scale_colours{{{0.125f, {0.15f, 0, 0}},
                                    {0.3f, {1, 0, 0}},
                                    {0.35f, {1, 0.25f, 0}},
                                    {0.6f, {1, 0.8f, 0.2f}},
                                    {1, {1, 1, 1}},
                                    {2.5f, {0.35f, 0.8f, 0.35f}},
                                    {5.9f, {0.1f, 0.5f, 1}},
                                    {6.1f, {0, 0, 1}},
                                    {8, {0, 0, 0.3f}}}};
    std::vector<Rgb> size_map, scale_map;
    for (size_t i = 0; i < image.mean.size(); ++i)
        size_map.push_back(sizes(covariance::filter_size(main_filter(field, in_view, image, i))));
    for (int y = 0; y < field.height; ++y)
        for (int x = 0; x < field.width; ++x) {
            const size_t k = nearest(pixels, x, y);
            const Rgb c = scale_colours(scales[k]);
            scale_map.push_back(narrowest[k] ? 0.3f * c + 0.7f * Rgb(0.2f) : c);
        }
    PanelPicture picture(field.width, field.height);
    picture.add(image.mean);
    picture.add(std::move(size_map), sizes, {0.5f, 1, 2, 5, 15});
    picture.add(std::move(scale_map), scale_colours, {0.125f, 0.35f, 0.6f, 1, 2.5f, 6, 8});
    picture.write_png(file);
}

void report(std::span<const char* const> files, bool by_neighbours, const char* map) {
    const PredictedImage predicted = read_predicted_image(files[0]);
    const std::vector<MeasuredPixel> pixels = read_pixels(files[1], predicted.image);
    const Converged image = read_converged(files.subspan(2), predicted.image);
    const FilterSettings settings = covariance::filter_settings(16);
    const Prediction& p = predicted.prediction;
    const FilterField field =
        by_neighbours ? predicted.filters
                      : filter_field(p.spectrum, p.width, p.height, FilterRule::verified, settings);
    const FilterField& in_view = predicted.in_view_filters;
    std::vector<bool> narrowest;
    for (const MeasuredPixel& m : pixels) {
        const size_t i = size_t(m.y) * size_t(field.width) + size_t(m.x);
        narrowest.push_back(covariance::eigen(main_filter(field, in_view, image, i)).high <
                            sqr(1.01f * settings.limits.s_min));
    }
    const float share =
        float(std::count(narrowest.begin(), narrowest.end(), true)) / float(pixels.size());
    UsableScales scales = usable_scales(field, in_view, image, pixels);
    if (map) write_map(map, field, in_view, image, pixels, scales.significant, narrowest);
    std::nth_element(scales.noise.begin(), scales.noise.begin() + ptrdiff_t(pixels.size() / 2),
                     scales.noise.end());
    const float noise = scales.noise[pixels.size() / 2];
    print_row("change > 2 %", std::move(scales.plain), share, noise);
    print_row("significant", std::move(scales.significant), share, noise);
    print_row("noise removed", scales.below, share, noise);
}

}  // namespace

int main(int argc, char** argv) {
    bool by_neighbours = true;
    const char* map = nullptr;
    std::vector<const char*> files;
    for (int i = 1; i < argc; ++i) {
        if (!std::strcmp(argv[i], "--no-neighbours"))
            by_neighbours = false;
        else if (!std::strcmp(argv[i], "--map") && i + 1 < argc)
            map = argv[++i];
        else
            files.push_back(argv[i]);
    }
    if (files.size() < 3) {
        fmt::print(stderr,
                   "usage: usable_scale [--no-neighbours] [--map MAP.png] IMAGE PIXELS CONVERGED "
                   "...\n");
        return 2;
    }
    try {
        report(files, by_neighbours, map);
    } catch (const std::exception& e) {
        fmt::print(stderr, "usable_scale: {}\n", e.what());
        return 1;
    }
}
