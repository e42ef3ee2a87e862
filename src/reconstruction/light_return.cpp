#include "reconstruction/light_return.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "core/vec.h"
#include "reconstruction/guides.h"
#include "reconstruction/luminance.h"

namespace covtrace {

namespace {

/// Sizes of levels: the finest has one value for 2 x 2 pixels, each other one for blocks 4 times as
/// wide and high as those of the level before.
constexpr int kFinest = 2, kFactor = 4, kLevels = 3;
/// Number of blocks of the finest level in one block of `level`, along x or y.
constexpr int blocks(int level) {
    int n = 1;
    for (int k = 0; k < level; ++k) n *= kFactor;
    return n;
}
/// Width of a block, pixels.
constexpr int side(int level) {
    return kFinest * blocks(level);
}
/// Factors k of the noise: that of the levels, and that of the whole image, whose samples are far
/// more even than their spread tells: the light that it lacks is mostly real. With 0 the error is 1
/// % larger at 4 samples per pixel.
constexpr float kNoise = 1, kNoiseOfAll = 0.1f;
/// Factor by which a place may become brighter at most; it may become darker by the same factor.
constexpr float kMostTimes = 10;

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
    for (int c = 0; c < 3; ++c)
        times[c] = std::clamp(certain * lacking[c] / light, 1 / kMostTimes - 1, kMostTimes - 1);
    return times;
}

/// The light that each block lacks, as multiples of its luminance (times_lacking).
ColorPlanes lacking(const Likeness& likeness, const ColorPlanes& e, const Plane& light,
                    const Plane& variance) {
    const int w = light.width, h = light.height;
    const std::vector<MarginPlane> means{MarginPlane(e[0]), MarginPlane(e[1]), MarginPlane(e[2]),
                                         MarginPlane(light)},
        variances{MarginPlane(variance)};
    ColorPlanes times;
    times.fill(Plane(w, h));
    parallel_for_rows(w, h, [&](int y) {
        for (int x = 0; x < w; ++x) {
            Likeness::Window weights;
            likeness.weigh(x, y, weights);
            float sum[4], square;
            weighted_sums(means, weights, x, y, sum);
            for (float& weight : weights) weight *= weight;
            weighted_sums(variances, weights, x, y, &square);
            const Rgb lack = times_lacking({sum[0], sum[1], sum[2]}, sum[3], square, kNoise);
            for (int c = 0; c < 3; ++c) times[size_t(c)](x, y) = lack[c];
        }
    });
    return times;
}

/// The sums of all light within some hundred pixels around every pixel.
Plane light_around(const Plane& light) {
    constexpr int size = side(kLevels - 1);
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

LightReturn::LightReturn(const Halves& halves, HalvesNoise noise) {
    if (noise == HalvesNoise::independent) {
        half_difference_ = luminance(halves[0].color);
        const Plane other = luminance(halves[1].color);
        for (size_t i = 0; i < other.size(); ++i)
            half_difference_[i] = 0.5f * (half_difference_[i] - other[i]);
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

Likeness LightReturn::likeness_of(int level, const Plane& light) const {
    // No share counts whatever is unlike: a window that counted in a wall's sums for a twentieth
    // would outshine the wall.
    Likeness likeness({.any = 0});
    for (const Plane& feature : features_) likeness.add(block_means(feature, blocks(level)));
    likeness.add(block_means(light_guide(light), side(level)));
    return likeness;
}

Plane LightReturn::variance_of(int level) const {
    if (half_difference_.size() > 0) {
        Plane square = block_means(half_difference_, side(level));
        for (float& v : square.values) v = sqr(v);
        return square;
    }
    Plane variance = block_means(variance_, blocks(level));
    for (float& v : variance.values) v /= sqr(float(blocks(level)));
    return variance;
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
    for (float v : variance_of(0).values) variance += sqr(sqr(double(kFinest))) * double(v);
    const Rgb times = times_lacking({float(lack[0]), float(lack[1]), float(lack[2])}, float(all),
                                    float(variance), kNoiseOfAll);
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
    // Give the rest back, level by level, to blocks that are alike
    for (int level = 0; level < kLevels; ++level) {
        const Plane light = luminance(color);
        ColorPlanes e = difference();
        for (size_t c = 0; c < 3; ++c) {
            for (size_t i = 0; i < light.size(); ++i) e[c][i] -= in_place[c][i];
            e[c] = block_means(e[c], side(level));
        }
        const ColorPlanes times = lacking(likeness_of(level, light), e,
                                          block_means(light, side(level)), variance_of(level));
        parallel_for_rows(w, h, [&](int y) {
            for (int x = 0; x < w; ++x)
                for (size_t c = 0; c < 3; ++c) {
                    float& v = color[c](x, y);
                    const float given = light(x, y) * interpolated(times[c], x, y, side(level));
                    v = std::max(std::min(v, 0.0f), v + given);
                }
        });
    }
    // Give what is still lacking to the whole image
    give_to_all(difference(), in_place, color);
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < color[c].size(); ++i) {
            float& v = color[c][i];
            v = std::max(std::min(v, 0.0f), v + kept[c][i]);
        }
}

}  // namespace covtrace
