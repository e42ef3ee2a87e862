/// What the prediction is for, measured: how far each pixel's predicted filter may be scaled.
///
///     usable_scale [--no-neighbours] [--map MAP.png] IMAGE.exr HALF.exr HALF.exr
///
/// IMAGE holds all layers of `render --method covariance`; of it only the covariances are used. The
/// halves are two converged images by `--method uniform` with different seeds. The filter of a
/// pixel is the renderer's at 16 samples per pixel: (4 pi^2 c^2 Sigma_2D)^-1, c = 2, deviations in
/// [0.5, 15] pixels, limited by narrower neighbours unless --no-neighbours is given. Its usable
/// scale is the largest factor on the deviations up to which all of these filters change the
/// pixel's converged luminance Y by at most 2 % of Y + 0.01, in steps of a quarter octave from 1/8
/// to 8. A perfect prediction has the same scale everywhere; one far below the typical value blurs.
///
/// The halves still hold noise, which a filter removes and which must not count as a change. Both
/// halves are filtered alike; the difference of their two changes is noise alone and gives its
/// standard deviation (root mean square over 5x5 pixels, at each scale). Two results are printed:
/// "change > 2 %" takes the mean change as it is, noise included, so its scales are too small;
/// "significant" asks for a change beyond 2 % by two standard deviations, so its scales are too
/// large. What no noise would give lies in between.
///
/// Prints a row of a Markdown table for each. MAP shows the converged image, the deviation of the
/// filter (fourth root of det S_h, pixels) and the usable scale (significant), where pixels with
/// the narrowest filter are greyed.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>
#include <vector>

#include "core/parallel.h"
#include "false_colour.h"
#include "predicted_image.h"
#include "reconstruction/gather.h"

using namespace covtrace;

namespace {

constexpr float kTolerance = 0.02f, kFloor = 0.01f;
constexpr float kSignificant = 2;  // standard deviations
constexpr int kStepsPerOctave = 4;
constexpr int kFirstStep = -3 * kStepsPerOctave, kLastStep = 3 * kStepsPerOctave;

struct Half {
    std::vector<Rgb> mean;
    std::vector<float> value;  // luminance

    explicit Half(const char* file, const Image& like) {
        const Image image = read_image(file);
        if (image.data != like.data)
            throw Error(ErrorKind::usage,
                        fmt::format("{}: has other pixels than the predicted image", file));
        for (size_t i = 0; i < image.pixel_count(); ++i) {
            mean.push_back(image.rgb(i));
            value.push_back(luminance(mean.back()));
        }
    }
    /// The change by the filters, luminance.
    std::vector<float> change(const FilterField& field) const {
        const std::vector<float> no_variance(mean.size(), 0.0f);
        const std::vector<uint32_t> count(mean.size(), 1);
        const GatheredImage filtered = gather(mean, no_variance, count, field);
        std::vector<float> result(mean.size());
        for (size_t i = 0; i < result.size(); ++i)
            result[i] = luminance(filtered.color[i]) - value[i];
        return result;
    }
};

/// Means over 5x5 pixels, fewer at the borders.
std::vector<float> mean_around(const std::vector<float>& values, int width, int height) {
    std::vector<float> result(values.size());
    parallel_for(height, [&](int64_t row) {
        for (int x = 0; x < width; ++x) {
            float sum = 0;
            int count = 0;
            for (int py = std::max(0, int(row) - 2); py <= std::min(height - 1, int(row) + 2); ++py)
                for (int px = std::max(0, x - 2); px <= std::min(width - 1, x + 2); ++px) {
                    sum += values[size_t(py) * size_t(width) + size_t(px)];
                    ++count;
                }
            result[size_t(row) * size_t(width) + size_t(x)] = sum / float(count);
        }
    });
    return result;
}

struct UsableScales {
    std::vector<float> plain, significant;  ///< 0: not even the smallest
};

UsableScales usable_scales(const FilterField& field, const Half& a, const Half& b) {
    const size_t n = field.covariance.size();
    UsableScales result{std::vector<float>(n, 0.0f), std::vector<float>(n, 0.0f)};
    std::vector<bool> plain_over(n), significant_over(n);
    for (int step = kFirstStep; step <= kLastStep; ++step) {
        const float s = std::exp2(float(step) / kStepsPerOctave);
        FilterField scaled = field;
        for (auto& c : scaled.covariance) c = s * s * c;
        const std::vector<float> change_a = a.change(scaled), change_b = b.change(scaled);
        std::vector<float> noise(n);
        for (size_t i = 0; i < n; ++i) noise[i] = sqr(0.5f * (change_a[i] - change_b[i]));
        noise = mean_around(noise, field.width, field.height);
        for (size_t i = 0; i < n; ++i) {
            const float change = 0.5f * std::abs(change_a[i] + change_b[i]);
            const float allowed = kTolerance * (0.5f * (a.value[i] + b.value[i]) + kFloor);
            if (change > allowed) plain_over[i] = true;
            if (change > allowed + kSignificant * std::sqrt(noise[i])) significant_over[i] = true;
            if (!plain_over[i]) result.plain[i] = s;
            if (!significant_over[i]) result.significant[i] = s;
        }
    }
    return result;
}

void print_row(std::string_view name, std::vector<float> scales, float narrowest_share) {
    std::sort(scales.begin(), scales.end());
    const auto quantile = [&](double p) { return scales[size_t(p * double(scales.size() - 1))]; };
    const auto share = [&](auto&& predicate) {
        return 100.0 * double(std::count_if(scales.begin(), scales.end(), predicate)) /
               double(scales.size());
    };
    fmt::print(
        "| {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.1f} % | {:.1f} % | {:.1f} % |\n",
        name, quantile(0.05), quantile(0.25), quantile(0.5), quantile(0.75), quantile(0.95),
        share([](float s) { return s < 0.35f; }), share([](float s) { return s > 6; }),
        100 * narrowest_share);
}

void write_map(const char* file, const FilterField& field, const Half& a, const Half& b,
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
    std::vector<Rgb> converged, size_map, scale_map;
    for (size_t i = 0; i < scales.size(); ++i) {
        converged.push_back(0.5f * (a.mean[i] + b.mean[i]));
        size_map.push_back(sizes(covariance::filter_size(field.covariance[i])));
        const Rgb c = scale_colours(scales[i]);
        scale_map.push_back(narrowest[i] ? 0.3f * c + 0.7f * Rgb(0.2f) : c);
    }
    PanelPicture picture(field.width, field.height);
    picture.add(std::move(converged));
    picture.add(std::move(size_map), sizes, {0.5f, 1, 2, 5, 15});
    picture.add(std::move(scale_map), scale_colours, {0.125f, 0.35f, 0.6f, 1, 2.5f, 6, 8});
    picture.write_png(file);
}

void report(const char* image, const char* first, const char* second, bool by_neighbours,
            const char* map) {
    const PredictedImage predicted = read_predicted_image(image);
    const Half a(first, predicted.image), b(second, predicted.image);
    const FilterSettings settings = filter_settings(16);
    const Prediction& p = predicted.prediction;
    FilterField field = filter_field(p.spectrum, p.width, p.height, FilterRule::verified, settings);
    if (by_neighbours) limit_by_neighbours(field, settings);
    std::vector<bool> narrowest;
    for (const auto& c : field.covariance)
        narrowest.push_back(covariance::eigen(c).high < sqr(1.01f * settings.limits.s_min));
    const float share =
        float(std::count(narrowest.begin(), narrowest.end(), true)) / float(narrowest.size());
    const UsableScales scales = usable_scales(field, a, b);
    print_row("change > 2 %", scales.plain, share);
    print_row("significant", scales.significant, share);
    if (map) write_map(map, field, a, b, scales.significant, narrowest);
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
    if (files.size() != 3) {
        fmt::print(stderr,
                   "usage: usable_scale [--no-neighbours] [--map MAP.png] IMAGE HALF HALF\n");
        return 2;
    }
    try {
        report(files[0], files[1], files[2], by_neighbours, map);
    } catch (const std::exception& e) {
        fmt::print(stderr, "usable_scale: {}\n", e.what());
        return 1;
    }
}
