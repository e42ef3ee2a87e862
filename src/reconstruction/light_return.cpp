#include "reconstruction/light_return.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "core/vec.h"
#include "reconstruction/guides.h"
#include "reconstruction/luminance.h"
#include "reconstruction/window_sums.h"

namespace covtrace {

namespace {

/// Pixels of a block, in x and in y: light is summed over blocks.
constexpr int kFinest = 2;
/// Widths of the windows: each next one is so many times as wide.
constexpr int kFactor = 4, kLevels = 3;
/// Deviation of the narrowest window, blocks.
constexpr float kDeviation = 6;
/// Blocks of the windows of `level` that stand for one another, from one to the next in x or y.
constexpr int stride(int level) {
    int n = 1;
    for (int k = 0; k < level; ++k) n *= kFactor;
    return n;
}
/// Factors k of the noise: that of the levels, and that of the whole image, whose samples are far
/// more even than their spread tells: the light that it lacks is mostly real. With 0 the error is 1
/// % larger at 4 samples per pixel.
constexpr float kNoise = 1, kNoiseOfAll = 0.1f;
/// Both factors where samples are few: with more the error is a little less, but the light of
/// tenths of the brightness is further off (docs/decisions/0117).
constexpr float kNoiseOfFew = 3;
/// Factor by which a place may become brighter at most; it may become darker by the same factor.
constexpr float kMostTimes = 10;

/// Limits the light that a place gets, as a multiple of its luminance.
float within_most(float times) {
    return std::clamp(times, 1 / kMostTimes - 1, kMostTimes - 1);
}

/// The means of blocks of `size` x `size` pixels; blocks at the border are smaller.
Plane block_means(const Plane& p, int size) {
    Plane mean((p.width + size - 1) / size, (p.height + size - 1) / size);
    for (int y = 0; y < mean.height; ++y)
        for (int x = 0; x < mean.width; ++x) {
            const int x1 = std::min(p.width, (x + 1) * size),
                      y1 = std::min(p.height, (y + 1) * size);
            float sum = 0;
            for (int v = y * size; v < y1; ++v)
                for (int u = x * size; u < x1; ++u) sum += p(u, v);
            mean(x, y) = sum / float((x1 - x * size) * (y1 - y * size));
        }
    return mean;
}

/// Reach within which light is one thing, pixels: a small lamp in view covers a few of them.
constexpr int kTogether = 3;
/// Share of all light around by which one thing may make it brighter. More would be seen as a glow
/// over the whole image, and stays where it is.
constexpr float kMostOfOneThing = 0.065f;

/// The value of blocks at a pixel: linear between the middles of the blocks, constant beyond the
/// outermost ones.
float interpolated(const Plane& p, int x, int y, int size) {
    const auto place = [size](int pixel, int count) {
        return std::clamp((float(pixel) + 0.5f) / float(size) - 0.5f, 0.0f, float(count - 1));
    };
    const float fx = place(x, p.width), fy = place(y, p.height);
    const int x0 = int(fx), y0 = int(fy), x1 = std::min(x0 + 1, p.width - 1),
              y1 = std::min(y0 + 1, p.height - 1);
    const float u = fx - float(x0), v = fy - float(y0);
    return (1 - v) * ((1 - u) * p(x0, y0) + u * p(x1, y0)) +
           v * ((1 - u) * p(x0, y1) + u * p(x1, y1));
}

/// The light that a place lacks in each channel, as multiples of its luminance. The arguments are
/// sums over the pixels that are alike: of the lacking light, of luminance and of the variance of
/// the lacking light.
Rgb times_lacking(Rgb lacking, float light, float variance, float noise) {
    const float certain = 1 - noise * variance / sqr(luminance(lacking));
    if (!(light > 0) || !(certain > 0)) return Rgb(0);  // also where a sum is not a number
    Rgb times;
    for (int c = 0; c < 3; ++c) times[c] = within_most(certain * lacking[c] / light);
    return times;
}

/// Planes of blocks that are summed over windows, in this order: the lacking light, luminance, and
/// what tells the noise of wider windows, one plane or two (noise_of_lack).
enum SummedPlane : size_t { kRed, kGreen, kBlue, kLight, kNoiseFirst, kNoiseSecond };

/// The variance of a window's lacking light, from level 1 on, at block i of its sums.
///
/// Halves of one sequence: an image has the noise of its samples, so that what it lacks over many
/// blocks is its own loss and no noise, unless few of them have lost it: then it is as uncertain as
/// it is large, lack^2 sum e^2 / (sum |e|)^2, sums over all blocks of the window with equal
/// weights. Those of level - 1 overlap, and each block counts in 2 pi kDeviation^2 / kFactor^2 of
/// them.
///
/// Independent halves: what they differ by in the narrower windows, squared, of which those that
/// overlap are no more certain than one.
float noise_of_lack(const WindowSums& sums, HalvesNoise noise, int level, size_t i, Rgb lack) {
    constexpr float kOverlap = 2 * kPi * sqr(kDeviation / kFactor);
    if (noise == HalvesNoise::independent) return 2 * kOverlap * sums.squares[0][i];
    const float absolute = sums.linear[kNoiseFirst][i];
    float times = sums.linear[kNoiseSecond][i] / sqr(absolute);  // of one block's e times is 1 then
    for (int k = 0; k < level; ++k) times *= kOverlap;
    return absolute > 0 ? sqr(luminance(lack)) * times : 0;
}

/// The sums of all light within some hundred pixels around every pixel.
Plane light_around(const Plane& light) {
    constexpr int size = kFinest * stride(kLevels - 1);
    const Likeness everything({.any = 1});
    const Plane means = block_means(light, size);
    const std::vector<MarginPlane> planes{MarginPlane(means)};
    Plane sum(means.width, means.height), around(light.width, light.height);
    parallel_for_rows(sum.width, sum.height, [&](int y) {
        for (int x = 0; x < sum.width; ++x) {
            Likeness::Window weights;
            everything.weigh(x, y, weights);
            weighted_sums(planes, weights, x, y, &sum(x, y));
        }
    });
    for (int y = 0; y < light.height; ++y)
        for (int x = 0; x < light.width; ++x)
            around(x, y) = sqr(float(size)) * interpolated(sum, x, y, size);
    return around;
}

/// Adds to `color` the part of e that stays in place: things that are too bright for their
/// surroundings.
void keep_in_place(const Plane& around, const ColorPlanes& e, ColorPlanes& color) {
    Plane together = luminance(e);
    for (float& v : together.values) v = std::abs(v);
    together = box_blur(together, kTogether);
    for (size_t i = 0; i < around.size(); ++i) {
        const float most = kMostOfOneThing * around[i],
                    thing = sqr(2 * kTogether + 1.0f) * together[i];
        if (!(thing > most)) continue;
        for (size_t c = 0; c < 3; ++c) color[c][i] += (1 - most / thing) * e[c][i];
    }
}

}  // namespace

LightReturn::LightReturn(const Halves& halves, HalvesNoise noise, float few)
    : noise_(noise),
      windows_noise_(std::lerp(kNoise, kNoiseOfFew, few)),
      all_noise_(std::lerp(kNoiseOfAll, kNoiseOfFew, few)) {
    if (noise == HalvesNoise::independent) {
        half_difference_ = luminance(halves[0].color);
        const Plane other = luminance(halves[1].color);
        for (size_t i = 0; i < other.size(); ++i)
            half_difference_[i] = 0.5f * (half_difference_[i] - other[i]);
        block_half_difference_ = block_means(half_difference_, kFinest);
    }
    for (size_t f = 0; f < kFeatures; ++f)
        features_.push_back(block_means(feature_guide(halves, f), kFinest));
    Plane variance(halves[0].count.width, halves[0].count.height);
    for (size_t i = 0; i < variance.size(); ++i) {
        Rgb deviation;
        for (int c = 0; c < 3; ++c)
            deviation[c] = 0.5f * std::sqrt(halves[0].color_variance[size_t(c)][i] +
                                            halves[1].color_variance[size_t(c)][i]);
        variance[i] = sqr(luminance(deviation));
    }
    variance_ = block_means(variance, kFinest);
    for (float& v : variance_.values) v /= sqr(float(kFinest));
}

Plane LightReturn::block_variance() const {
    if (noise_ == HalvesNoise::of_one_sequence) return variance_;
    Plane square = block_half_difference_;
    for (float& v : square.values) v *= v;
    return square;
}

ColorPlanes LightReturn::lacking(const ColorPlanes& e, const Plane& light) const {
    std::vector<Plane> guides = features_;
    guides.push_back(block_means(light_guide(light), kFinest));
    const Plane block_light = block_means(light, kFinest);
    std::vector<Plane> summed{e[0], e[1], e[2], block_light};
    if (noise_ == HalvesNoise::independent) {
        summed.push_back(block_half_difference_);
    } else {
        summed.insert(summed.end(), 2, luminance(e));
        for (float& v : summed[kNoiseFirst].values) v = std::abs(v);
        for (float& v : summed[kNoiseSecond].values) v *= v;
    }
    ColorPlanes times;
    times.fill(Plane(e[0].width, e[0].height));
    std::vector<Plane> squares{block_variance()};
    for (int level = 0; level < kLevels; ++level) {
        // No share counts whatever is unlike: a window that counted in a wall's sums for a
        // twentieth would outshine the wall.
        WindowSums sums =
            window_sums(guides, summed, squares, stride(level), {.sigma = kDeviation, .any = 0});
        for (size_t i = 0; i < times[0].size(); ++i) {
            const Rgb lack(sums.linear[kRed][i], sums.linear[kGreen][i], sums.linear[kBlue][i]);
            const float variance =
                level == 0 ? sums.squares[0][i] : noise_of_lack(sums, noise_, level, i, lack);
            const float all = sums.linear[kLight][i];
            const Rgb given = times_lacking(lack, all, variance, windows_noise_);
            for (size_t c = 0; c < 3; ++c) {
                times[c][i] += given[int(c)];
                sums.linear[c][i] -= given[int(c)] * all;  // the wider windows lack it no more
            }
        }
        summed = std::move(sums.linear);
        squares.clear();
        if (noise_ == HalvesNoise::independent) {
            squares.push_back(summed[kNoiseFirst]);
            for (float& v : squares[0].values) v *= v;
        }
    }
    return times;
}

void LightReturn::give_to_all(const ColorPlanes& e, const ColorPlanes& in_place,
                              ColorPlanes& color) const {
    const Plane light = luminance(color);
    std::array<double, 3> lack{};
    double all = 0, variance = 0;
    for (size_t i = 0; i < light.size(); ++i) {
        for (size_t c = 0; c < 3; ++c) lack[c] += double(e[c][i] - in_place[c][i]);
        all += double(light[i]);
    }
    for (float v : block_variance().values) variance += sqr(sqr(double(kFinest))) * double(v);
    const Rgb times = times_lacking({float(lack[0]), float(lack[1]), float(lack[2])}, float(all),
                                    float(variance), all_noise_);
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < light.size(); ++i) {
            float& v = color[c][i];
            v = std::max(std::min(v, 0.0f), v + light[i] * times[int(c)]);
        }
}

void LightReturn::keep_what_both_saw(const ColorPlanes& e, ColorPlanes& in_place) const {
    if (half_difference_.size() == 0) return;
    const Plane lacking = luminance(e);
    for (size_t i = 0; i < lacking.size(); ++i) {
        const float square = sqr(lacking[i]);
        const float share = square > 0 ? std::max(0.0f, 1 - sqr(half_difference_[i]) / square) : 0;
        for (Plane& channel : in_place) channel[i] *= share;
    }
}

void LightReturn::give_back(const ColorPlanes& raw, ColorPlanes& color) const {
    const int w = color[0].width, h = color[0].height;
    const auto difference = [&raw, &color] {
        ColorPlanes e = raw;
        for (size_t c = 0; c < 3; ++c)
            for (size_t i = 0; i < e[c].size(); ++i) e[c][i] -= color[c][i];
        return e;
    };
    // Find the light that stays in its pixels, and is not given to all
    ColorPlanes in_place = color;
    keep_in_place(light_around(luminance(color)), difference(), in_place);
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < color[c].size(); ++i) in_place[c][i] -= color[c][i];
    ColorPlanes kept = in_place;
    keep_what_both_saw(difference(), kept);
    // Give the rest back to blocks that are alike
    const Plane light = luminance(color);
    ColorPlanes e = difference();
    for (size_t c = 0; c < 3; ++c) {
        for (size_t i = 0; i < light.size(); ++i) e[c][i] -= in_place[c][i];
        e[c] = block_means(e[c], kFinest);
    }
    const ColorPlanes times = lacking(e, light);
    parallel_for_rows(w, h, [&](int y) {
        for (int x = 0; x < w; ++x)
            for (size_t c = 0; c < 3; ++c) {
                float& v = color[c](x, y);
                const float given =
                    light(x, y) * within_most(interpolated(times[c], x, y, kFinest));
                v = std::max(std::min(v, 0.0f), v + given);
            }
    });
    // Give what is still lacking to the whole image
    give_to_all(difference(), in_place, color);
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < color[c].size(); ++i) {
            float& v = color[c][i];
            v = std::max(std::min(v, 0.0f), v + kept[c][i]);
        }
}

}  // namespace covtrace
