#include "reconstruction/light_return.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "core/vec.h"
#include "reconstruction/guides.h"
#include "reconstruction/light_in_place.h"
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
/// Independent places that sums over Gaussian windows at every kFactor-th place count several
/// times: the variance of a sum of such sums is so many times that of independent ones.
constexpr float kOverlap = 4 * kPi * sqr(kDeviation / kFactor);
/// Factors k of the noise: that of the windows, and that of the whole image, whose samples are far
/// more even than their spread tells: the light that it lacks is mostly real.
constexpr float kNoise = 1, kNoiseOfAll = 0.1f;
/// Both factors with 4 samples per pixel: with more the error is a little less, but the light of
/// tenths of the brightness is further off (docs/decisions/0117).
constexpr float kNoiseOfFew = 3;
/// Share of its light by which the whole image may become brighter at most. More, as of lamps that
/// are smaller than a pixel, would be seen in what has no noise, and stays in the brightest pixels;
/// with a share as small as that of one thing the rare paths of dim rooms would stay in theirs.
constexpr float kMostToAll = 0.15f;
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

/// Planes of blocks that are summed over windows, in this order: the lacking light, the image's own
/// and the lacking luminance without its sign and squared or, of halves with noise of their own,
/// half of what they differ by.
enum SummedPlane : size_t { kLacking, kSeen = 3, kAbsolute = 6, kSquared, kHalfDifference = 6 };
/// Planes that are summed with squared weights: products of the lacking luminance and the image's
/// own over narrower windows, what the first one should be were it noise, and the variance that the
/// samples tell.
enum SquaresPlane : size_t { kLackSquared, kLackLight, kLightSquared, kExpected, kTold };

Rgb rgb_at(const std::vector<Plane>& planes, size_t first, size_t i) {
    return {planes[first][i], planes[first + 1][i], planes[first + 2][i]};
}

/// `over` / `under`, 0 without light.
float ratio(float over, float under) {
    return under > 0 ? over / under : 0;
}

/// The sum of squares of the lacking luminance around its mean in the window.
float scatter(const WindowSums& sums, size_t i) {
    const float t = ratio(luminance(rgb_at(sums.linear, kLacking, i)),
                          luminance(rgb_at(sums.linear, kSeen, i)));
    return std::max(0.0f, sums.squares[kLackSquared][i] - 2 * t * sums.squares[kLackLight][i] +
                              t * t * sums.squares[kLightSquared][i]);
}

/// The light that the whole image lacks in each channel, as multiples of its luminance. The
/// arguments are sums over it: of the lacking light, of luminance and of the variance of the
/// lacking light.
Rgb times_lacking(Rgb lacking, float light, float variance, float noise) {
    const float certain = 1 - noise * variance / sqr(luminance(lacking));
    if (!(light > 0) || !(certain > 0)) return Rgb(0);  // also where a sum is not a number
    Rgb times;
    for (int c = 0; c < 3; ++c) times[c] = within_most(certain * lacking[c] / light);
    return times;
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

/// The variance of a wider window's lacking light by how few places it is from, its square where it
/// is from one: sum e^2 / (sum |e|)^2 of that, sums over all blocks of the window with equal
/// weights. Those of level - 1 overlap, and each block counts in kOverlap / 2 of them.
float noise_of_few_places(const WindowSums& sums, int level, size_t i) {
    float places = sqr(sums.linear[kAbsolute][i]);
    for (int k = 0; k < level; ++k) places /= kOverlap / 2;
    return ratio(sqr(luminance(rgb_at(sums.linear, kLacking, i))) * sums.linear[kSquared][i],
                 places);
}

ColorPlanes minus(ColorPlanes a, const ColorPlanes& b) {
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < a[c].size(); ++i) a[c][i] -= b[c][i];
    return a;
}

}  // namespace

/// Sums over windows of one width, and the variance of the lacking luminance.
struct LightReturn::Level {
    std::vector<Plane> sums;  ///< by SummedPlane
    Plane noise;
};

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

Plane LightReturn::share_that_is_real(std::span<const Plane> guides, int level, const Plane& noise,
                                      const Plane& squared, const Plane& light) const {
    // Means relative to the light count by the light: by its square they would be those of lamps
    std::vector<Plane> around{noise, squared, light};
    for (size_t i = 0; i < light.size(); ++i) {
        around[0][i] = ratio(noise[i], light[i]);
        around[1][i] = ratio(squared[i], light[i]);
        around[2][i] = std::max(0.0f, light[i]);
    }
    if (level + 1 < kLevels) {
        around = window_sums(guides, around, {}, stride(level + 1), {.sigma = kDeviation, .any = 0})
                     .linear;
    } else {
        for (Plane& p : around) {
            double sum = 0;
            for (float v : p.values) sum += double(v);
            std::fill(p.values.begin(), p.values.end(), float(sum));
        }
    }
    Plane share = noise;
    for (size_t i = 0; i < noise.size(); ++i) {
        const float times = ratio(sqr(light[i]), around[2][i]),
                    uncertain = windows_noise_ * std::max(noise[i], times * around[0][i]),
                    lacking = times * std::max(0.0f, around[1][i] - windows_noise_ * around[0][i]);
        share[i] = ratio(lacking, lacking + uncertain);
    }
    return share;
}

std::vector<LightReturn::Level> LightReturn::levels(const ColorPlanes& e, const ColorPlanes& color,
                                                    std::span<const Plane> guides) const {
    const bool independent = noise_ == HalvesNoise::independent;
    std::vector<Plane> summed(e.begin(), e.end());
    for (const Plane& channel : color) summed.push_back(block_means(channel, kFinest));
    if (independent) {
        summed.push_back(block_half_difference_);
    } else {
        summed.insert(summed.end(), 2, luminance(e));
        for (float& v : summed[kAbsolute].values) v = std::abs(v);
        for (float& v : summed[kSquared].values) v *= v;
    }
    std::vector<Plane> squares(kTold + 1, block_variance());
    const size_t n = e[0].size();
    std::vector<Level> levels(kLevels);
    for (int level = 0; level < kLevels; ++level) {
        for (size_t i = 0; i < n; ++i) {
            const Rgb lack = rgb_at(summed, kLacking, i), seen = rgb_at(summed, kSeen, i);
            squares[kLackSquared][i] = sqr(luminance(lack));
            squares[kLackLight][i] = luminance(lack) * luminance(seen);
            squares[kLightSquared][i] = sqr(luminance(seen));
            if (independent && level > 0) squares[kTold][i] = sqr(summed[kHalfDifference][i]);
        }
        const WindowSums sums =
            window_sums(guides, summed, squares, stride(level), {.sigma = kDeviation, .any = 0});
        Level& of = levels[size_t(level)];
        of.noise = Plane(e[0].width, e[0].height);
        const float overlap = level == 0 ? 1 : kOverlap;
        for (size_t i = 0; i < n; ++i) {
            const float spread = scatter(sums, i);
            // An image keeps noise of its samples, and does not lack it: the wider the windows,
            // the less of it. It falls on as it fell from the narrower windows to these.
            const float falls =
                level == 0 ? 1 : std::min(1.0f, ratio(spread, sums.squares[kExpected][i]));
            if (independent || level == 0)
                of.noise[i] = overlap * sums.squares[kTold][i];
            else
                of.noise[i] =
                    std::max(overlap * falls * spread, noise_of_few_places(sums, level, i));
            squares[kExpected][i] = overlap * spread;
        }
        of.sums = summed = sums.linear;
    }
    return levels;
}

Plane LightReturn::lacking(const ColorPlanes& e, const ColorPlanes& color) const {
    std::vector<Plane> guides = features_;
    guides.push_back(block_means(light_guide(luminance(color)), kFinest));
    const std::vector<Level> all = levels(e, color, guides);
    const Plane none(e[0].width, e[0].height);
    Plane times = none;
    for (int level = kLevels - 1; level >= 0; --level) {
        const Level& of = all[size_t(level)];
        // Find what the wider windows left
        Plane rest = none, squared = none, light = none;
        for (size_t i = 0; i < none.size(); ++i) {
            light[i] = luminance(rgb_at(of.sums, kSeen, i));
            rest[i] = luminance(rgb_at(of.sums, kLacking, i)) - times[i] * light[i];
            squared[i] = sqr(rest[i]);
        }
        const Plane share = share_that_is_real(guides, level, of.noise, squared, light);
        for (size_t i = 0; i < none.size(); ++i) {
            const float given = share[i] * rest[i] / light[i];
            if (light[i] > 0 && std::isfinite(given)) times[i] += within_most(given);
        }
    }
    return times;
}

void LightReturn::give_to_all(const ColorPlanes& e, ColorPlanes& color) const {
    const Plane light = luminance(color);
    std::array<double, 3> lack{};
    double all = 0, variance = 0;
    for (size_t i = 0; i < light.size(); ++i) {
        for (size_t c = 0; c < 3; ++c) lack[c] += double(e[c][i]);
        all += double(light[i]);
    }
    for (float v : block_variance().values) variance += sqr(sqr(double(kFinest))) * double(v);
    Rgb times = times_lacking({float(lack[0]), float(lack[1]), float(lack[2])}, float(all),
                              float(variance), all_noise_);
    if (const float brighter = luminance(times); brighter > kMostToAll) {
        keep_brightest(e, (brighter - kMostToAll) * float(all), color);
        times *= kMostToAll / brighter;
    }
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
    // Find the light that stays in its pixels, and is not given to all
    ColorPlanes in_place = color;
    keep_in_place(light_around(luminance(color)), minus(raw, color), in_place);
    in_place = minus(std::move(in_place), color);
    ColorPlanes kept = in_place;
    keep_what_both_saw(minus(raw, color), kept);
    // Give the rest back to blocks that are alike
    ColorPlanes e = minus(minus(raw, color), in_place);
    for (Plane& channel : e) channel = block_means(channel, kFinest);
    const Plane times = lacking(e, color);
    parallel_for_rows(w, h, [&](int y) {
        for (int x = 0; x < w; ++x) {
            const float brighter = within_most(interpolated(times, x, y, kFinest));
            for (Plane& channel : color) channel(x, y) += brighter * std::max(0.0f, channel(x, y));
        }
    });
    // Give what is still lacking to the whole image
    give_to_all(minus(minus(raw, color), in_place), color);
    for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < color[c].size(); ++i) {
            float& v = color[c][i];
            v = std::max(std::min(v, 0.0f), v + kept[c][i]);
        }
}

}  // namespace covtrace
