#include "image/compare.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "image/color_encoding.h"
#include "image/flip.h"

namespace covtrace {

namespace {

std::string to_string(const PixelBounds& b) {
    return std::to_string(b.x0) + "," + std::to_string(b.y0) + "," + std::to_string(b.x1) + "," +
           std::to_string(b.y1);
}

std::string size_string(const PixelBounds& b) {
    return std::to_string(b.width()) + "x" + std::to_string(b.height());
}

PixelBounds common_pixels(const Image& image, const Image& reference,
                          const std::optional<PixelBounds>& crop) {
    const auto size = [](const Image& i) { return size_string(i.display); };
    if (size(image) != size(reference))
        throw Error(ErrorKind::usage, "the images have different sizes: " + size(image) +
                                          " and the reference " + size(reference));
    if (image.display != reference.display)
        throw Error(ErrorKind::usage,
                    "the images have different display windows: " + to_string(image.display) +
                        " and the reference " + to_string(reference.display));
    PixelBounds common = intersection(image.data, reference.data);
    if (!crop && common != image.data && common != reference.data)
        throw Error(ErrorKind::usage, "the images hold different pixels: data windows " +
                                          to_string(image.data) + " and the reference " +
                                          to_string(reference.data) +
                                          "; give a crop that both contain");
    if (crop) common = intersection(common, *crop);
    if (common.empty())
        throw Error(ErrorKind::usage, "the images have no pixels in common" +
                                          (crop ? " in the crop " + to_string(*crop) : ""));
    return common;
}

/// The root colours of the pixels in `bounds`, row by row.
std::vector<Rgb> root_colors(const Image& image, const PixelBounds& bounds, const char* role) {
    const Channel *r = image.find("R"), *g = image.find("G"), *b = image.find("B");
    if (!r || !g || !b) r = g = b = image.find("Y");
    if (!r) throw Error(ErrorKind::usage, std::string(role) + " has no root channels R, G, B or Y");
    std::vector<Rgb> colors;
    colors.reserve(size_t(bounds.width()) * size_t(bounds.height()));
    for (int y = bounds.y0; y < bounds.y1; ++y)
        for (int x = bounds.x0; x < bounds.x1; ++x) {
            const size_t i =
                size_t(y - image.data.y0) * size_t(image.width()) + size_t(x - image.data.x0);
            colors.emplace_back(r->values[i], g->values[i], b->values[i]);
        }
    return colors;
}

int64_t count_nonfinite(const Image& image, const PixelBounds& bounds) {
    int64_t count = 0;
    for (const Channel& channel : image.channels)
        for (int y = bounds.y0; y < bounds.y1; ++y) {
            const float* row = &channel.values[size_t(y - image.data.y0) * size_t(image.width())];
            count +=
                std::count_if(row + (bounds.x0 - image.data.x0), row + (bounds.x1 - image.data.x0),
                              [](float v) { return !std::isfinite(v); });
        }
    return count;
}

bool same_bits(const Image& a, const Image& b) {
    if (a.data != b.data || a.display != b.display || a.channels.size() != b.channels.size())
        return false;
    return std::all_of(a.channels.begin(), a.channels.end(), [&](const Channel& channel) {
        const Channel* other = b.find(channel.name);
        return other && other->values.size() == channel.values.size() &&
               std::memcmp(other->values.data(), channel.values.data(),
                           channel.values.size() * sizeof(float)) == 0;
    });
}

/// Relative error of every compared pixel: the mean over its channels of (I - R)² / (R² + eps²).
std::vector<double> relative_errors(const std::vector<Rgb>& image,
                                    const std::vector<Rgb>& reference,
                                    const std::vector<bool>& compared, double eps_squared) {
    std::vector<double> errors;
    errors.reserve(image.size());
    for (size_t i = 0; i < image.size(); ++i) {
        if (!compared[i]) continue;
        double error = 0;
        for (int c = 0; c < 3; ++c) {
            const double v = image[i][c], r = reference[i][c];
            error += (v - r) * (v - r) / (r * r + eps_squared) / 3;
        }
        errors.push_back(error);
    }
    return errors;
}

/// The eps² of relmse_median: the square of a tenth of the reference's median luminance.
double squared_tenth_of_median(const std::vector<Rgb>& reference,
                               const std::vector<bool>& compared) {
    std::vector<double> values;
    values.reserve(reference.size());
    for (size_t i = 0; i < reference.size(); ++i)
        if (compared[i]) values.push_back(double(luminance(reference[i])));
    const auto middle = values.begin() + ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    double typical = *middle;
    if (!(typical > 0))
        typical = std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
    if (!(typical > 0)) typical = 1;
    return 0.01 * typical * typical;
}

std::array<double, kDeciles> decile_ratio(const std::vector<Rgb>& image,
                                          const std::vector<Rgb>& reference,
                                          const std::vector<bool>& compared,
                                          const PixelBounds& bounds) {
    Plane brightness(bounds.width(), bounds.height(), std::numeric_limits<float>::quiet_NaN());
    for (size_t i = 0; i < reference.size(); ++i)
        if (compared[i]) brightness[i] = luminance(reference[i]);
    const std::vector<uint8_t> deciles = brightness_deciles(brightness);
    std::array<double, kDeciles> sum{}, reference_sum{}, ratio{};
    for (size_t i = 0; i < deciles.size(); ++i) {
        if (deciles[i] == kNoDecile) continue;
        sum[deciles[i]] += double(luminance(image[i]));
        reference_sum[deciles[i]] += double(brightness[i]);
    }
    for (size_t k = 0; k < kDeciles; ++k) ratio[k] = sum[k] / reference_sum[k];
    return ratio;
}

/// Mean of the errors without the floor(n / 1000) largest.
double trimmed_mean(std::vector<double> errors) {
    const size_t kept = errors.size() - errors.size() / 1000;
    std::nth_element(errors.begin(), errors.begin() + ptrdiff_t(kept) - 1, errors.end());
    double sum = 0;
    for (size_t i = 0; i < kept; ++i) sum += errors[i];
    return sum / double(kept);
}

Rgb clamped(Rgb c) {
    return {clamp01(c.r), clamp01(c.g), clamp01(c.b)};
}

std::vector<float> flip_map(std::vector<Rgb> image, std::vector<Rgb> reference,
                            const std::vector<bool>& compared, const PixelBounds& bounds) {
    for (size_t i = 0; i < image.size(); ++i) {
        // Pixels that are left out get the same value in both images, because the eye's filters
        // reach over them.
        image[i] = compared[i] ? clamped(image[i]) : Rgb();
        reference[i] = compared[i] ? clamped(reference[i]) : Rgb();
    }
    std::vector<float> errors = flip_error(image, reference, bounds.width(), bounds.height());
    for (size_t i = 0; i < errors.size(); ++i)
        if (!compared[i]) errors[i] = 0;
    return errors;
}

}  // namespace

Comparison compare(const Image& image, const Image& reference, std::optional<PixelBounds> crop) {
    const PixelBounds bounds = common_pixels(image, reference, crop);
    const std::vector<Rgb> colors = root_colors(image, bounds, "the image");
    const std::vector<Rgb> references = root_colors(reference, bounds, "the reference");

    Comparison result;
    result.identical = same_bits(image, reference);
    result.nonfinite = count_nonfinite(image, bounds);
    result.bounds = bounds;

    std::vector<bool> compared(colors.size());
    double sum = 0, encoded_sum = 0;
    std::array<double, 3> image_sum{}, reference_sum{};
    for (size_t i = 0; i < colors.size(); ++i) {
        compared[i] = is_finite(colors[i]) && is_finite(references[i]);
        if (!compared[i]) continue;
        ++result.pixels;
        for (int c = 0; c < 3; ++c) {
            const double v = colors[i][c], r = references[i][c];
            const double encoded = double(srgb_encode(clamp01(colors[i][c]))) -
                                   double(srgb_encode(clamp01(references[i][c])));
            sum += (v - r) * (v - r);
            encoded_sum += encoded * encoded;
            image_sum[size_t(c)] += v;
            reference_sum[size_t(c)] += r;
        }
    }
    const double values = 3.0 * double(result.pixels);
    for (size_t c = 0; c < 3; ++c) result.mean_ratio[c] = image_sum[c] / reference_sum[c];
    result.decile_ratio = decile_ratio(colors, references, compared, bounds);
    if (result.pixels == 0) {
        constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
        result.mse = result.relmse = result.relmse_trimmed = result.relmse_median = result.psnr =
            result.flip = kNan;
        result.flip_map.assign(colors.size(), 0.0f);
        return result;
    }
    result.mse = sum / values;
    std::vector<double> errors = relative_errors(colors, references, compared, 0.01);
    result.relmse = std::accumulate(errors.begin(), errors.end(), 0.0) / double(result.pixels);
    result.relmse_trimmed = trimmed_mean(std::move(errors));
    result.relmse_median = trimmed_mean(relative_errors(
        colors, references, compared, squared_tenth_of_median(references, compared)));
    result.psnr = -10 * std::log10(encoded_sum / values);
    result.flip_map = flip_map(colors, references, compared, bounds);
    double flip_sum = 0;
    for (float error : result.flip_map) flip_sum += error;
    result.flip = flip_sum / double(result.pixels);
    return result;
}

}  // namespace covtrace
