#include "shading/image_spectrum.h"

#include <deque>
#include <numeric>

#include "core/once.h"
#include "core/parallel.h"
#include "shading/scalar_field.h"

namespace covtrace {
namespace {

/// Standard deviation over mean from which on a structure counts in full.
constexpr float kFullContrast = 0.1f;
/// Means below this share of the image's mean count as this.
constexpr float kDarkest = 0.01f;
/// Least ratio of the smaller to the larger eigenvalue: structures bend, so that none is as long as
/// its straight part makes it look.
constexpr float kMinEigenvalueRatio = 0.1f;
/// The variance about the trend is a difference; below this share of its minuend it is rounding.
constexpr float kMinDetrended = 0.03f;

using Covariance = SpatialCovariance2;  // in cycles^2 per analysed texel^2 within this file

/// The image and its square at one level of the pyramid, cells of `spacing` texels.
struct Level {
    ScalarField value, square;
    float spacing = 1;
};

/// What Gaussian windows of one size see, for each cell of their level.
struct WindowStatistics {
    ScalarField mean;
    ScalarField variance;       ///< of the values about their linear trend
    ScalarField gxx, gxy, gyy;  ///< covariance of the gradient, per texel^2
};

/// Calls body(row) for all rows in parallel; rows must be independent.
template <typename Body>
void for_each_row(int height, const Body& body) {
    parallel_for(height, [&](int64_t y) { body(int(y)); });
}

/// Means of gradient products over the four corners of each cell. A corner's gradient is centred
/// alike in x and y, so that a straight edge has one direction; but it doesn't see a checkerboard
/// of single cells, which only the finest level can hold: there half of it is plain differences.
void gradient_products(const Level& level, WindowStatistics& out) {
    const ScalarField& f = level.value;
    const float per_texel2 = 1 / (level.spacing * level.spacing);
    const float plain = level.spacing > 1 ? 0.0f : 0.5f;
    out.gxx = out.gxy = out.gyy = f.like_this();
    for_each_row(f.height, [&](int y) {
        const float* rows[3] = {f.row(f.row_index(y - 1)), f.row(y), f.row(f.row_index(y + 1))};
        for (int x = 0; x < f.width; ++x) {
            const int columns[3] = {f.column_index(x - 1), x, f.column_index(x + 1)};
            float xx = 0, xy = 0, yy = 0;
            for (int j = 0; j < 2; ++j)
                for (int i = 0; i < 2; ++i) {
                    const float a = rows[j][columns[i]], b = rows[j][columns[i + 1]];
                    const float c = rows[j + 1][columns[i]], d = rows[j + 1][columns[i + 1]];
                    const float gx = 0.5f * (b - a + d - c), gy = 0.5f * (c - a + d - b);
                    xx += 0.25f * gx * gx;
                    xy += 0.25f * gx * gy;
                    yy += 0.25f * gy * gy;
                }
            if (plain > 0) {
                const float value = rows[1][x];
                const auto square = [&](float v) { return 0.5f * sqr(v - value); };
                xx += plain * (square(rows[1][columns[0]]) + square(rows[1][columns[2]]) - xx);
                yy += plain * (square(rows[0][x]) + square(rows[2][x]) - yy);
            }
            out.gxx.row(y)[x] = xx * per_texel2;
            out.gxy.row(y)[x] = xy * per_texel2;
            out.gyy.row(y)[x] = yy * per_texel2;
        }
    });
}

WindowStatistics window_statistics(const Level& level, float std_in_cells) {
    const GaussianWindow window(std_in_cells);
    WindowStatistics w;
    gradient_products(level, w);
    w.gxx = smooth(w.gxx, window);
    w.gxy = smooth(w.gxy, window);
    w.gyy = smooth(w.gyy, window);
    w.mean = smooth(level.value, window);
    w.variance = smooth(level.square, window);
    // The window's variance per axis in texels: its own and that of the filters before it.
    const float spacing2 = level.spacing * level.spacing;
    const float spread = window.variance * spacing2 + 0.25f * (spacing2 - 1);
    const ScalarField& mean = w.mean;
    for_each_row(mean.height, [&](int y) {
        const float *above = mean.row(mean.row_index(y - 1)),
                    *below = mean.row(mean.row_index(y + 1)), *row = mean.row(y);
        for (int x = 0; x < mean.width; ++x) {
            // The gradient of the windowed mean is the mean gradient, and the slope of the
            // regression line in a Gaussian window (Stein's lemma).
            const float gx = 0.5f *
                             (row[mean.column_index(x + 1)] - row[mean.column_index(x - 1)]) /
                             level.spacing;
            const float gy = 0.5f * (below[x] - above[x]) / level.spacing;
            float& variance = w.variance.row(y)[x];
            variance = std::max(0.0f, variance - row[x] * row[x]);
            variance = std::max(kMinDetrended * variance, variance - spread * (gx * gx + gy * gy));
            w.gxx.row(y)[x] = std::max(0.0f, w.gxx.row(y)[x] - gx * gx);
            w.gyy.row(y)[x] = std::max(0.0f, w.gyy.row(y)[x] - gy * gy);
            w.gxy.row(y)[x] -= gx * gy;
        }
    });
    return w;
}

/// One window's estimate from the gradient's covariance c.
Covariance estimate(Covariance c, float variance, float mean, float window) {
    if (!(variance > 0)) return {};
    const float trace = c.ss + c.tt;
    const float visible = std::min(1.0f, variance / sqr(kFullContrast * mean));
    const float resolved = std::min(1.0f, window * window * trace / variance);
    const float f = visible * resolved / (2 * kPi * kPi * variance);
    const float limit = std::sqrt(c.ss * c.tt);
    return {f * c.ss, f * std::clamp(c.st, -limit, limit), f * c.tt};
}

/// Raises the smaller eigenvalue where it is too small.
Covariance bounded_anisotropy(Covariance c) {
    const float half_trace = 0.5f * (c.ss + c.tt);
    const float radius = std::sqrt(0.25f * sqr(c.ss - c.tt) + c.st * c.st);
    const float larger = half_trace + radius, smaller = half_trace - radius;
    const float missing = kMinEigenvalueRatio * larger - smaller;
    if (!(missing > 0)) return c;
    const float f = missing / (larger - smaller);
    return {c.ss + f * (larger - c.ss), c.st - f * c.st, c.tt + f * (larger - c.tt)};
}

std::vector<Level> make_pyramid(ScalarField value) {
    ScalarField square = value;
    for (float& v : square.values) v *= v;
    std::vector<Level> levels;
    levels.push_back({std::move(value), std::move(square), 1});
    while (std::max(levels.back().value.width, levels.back().value.height) > 2) {
        const Level& finer = levels.back();
        levels.push_back({halved(finer.value), halved(finer.square), 2 * finer.spacing});
    }
    return levels;
}

/// The largest estimate by trace of all windows so far, from the widest to the finest.
class Accumulator {
  public:
    explicit Accumulator(float image_mean) : image_mean_(image_mean) {}

    /// Estimates of the windows with a standard deviation of `std_in_cells` at this level.
    void add(const Level& level, float std_in_cells) {
        WindowStatistics w = window_statistics(level, std_in_cells);
        const int width = w.mean.width, height = w.mean.height;
        if (wider_variance_.values.empty()) {
            wider_variance_ = w.variance;
            ss = st = tt = w.mean.like_this();
        } else if (wider_variance_.width != width || wider_variance_.height != height) {
            for (ScalarField* f : {&wider_variance_, &ss, &st, &tt})
                *f = doubled(*f, width, height);
        }
        const float window = std_in_cells * level.spacing;
        for_each_row(height, [&](int y) {
            for (int x = 0; x < width; ++x) {
                const float mean =
                    std::max(w.mean.row(y)[x] + image_mean_, kDarkest * std::abs(image_mean_));
                // A window alone underestimates the variance of waves longer than itself.
                const float variance = std::max(w.variance.row(y)[x], wider_variance_.row(y)[x]);
                const Covariance c{w.gxx.row(y)[x], w.gxy.row(y)[x], w.gyy.row(y)[x]};
                const Covariance e = estimate(c, variance, mean, window);
                if (e.ss + e.tt <= ss.row(y)[x] + tt.row(y)[x]) continue;
                ss.row(y)[x] = e.ss;
                st.row(y)[x] = e.st;
                tt.row(y)[x] = e.tt;
            }
        });
        wider_variance_ = std::move(w.variance);
    }

    ScalarField ss, st, tt;

  private:
    float image_mean_;
    ScalarField wider_variance_;
};

/// Index range of a bilinear lookup on an axis of n cells; any float gives valid indices.
struct AxisTaps {
    int first = 0, second = 0;
    float weight = 0;
};
AxisTaps axis_taps(float coordinate, float cells_per_unit, int n, bool repeats) {
    float c = repeats ? coordinate - std::floor(coordinate) : coordinate;
    c = c > 0 ? std::min(c, 1.0f) : 0.0f;
    const float x = c * cells_per_unit - 0.5f;
    const float below = std::floor(x);
    return {ScalarField::wrapped(int(below), n, repeats),
            ScalarField::wrapped(int(below) + 1, n, repeats), x - below};
}

}  // namespace

/// The image at one resolution and, from the first look-up on, its analysis.
class ImageSpectrum::Scale {
  public:
    Scale(const ScalarField& image, float mean, Vec2 texels_per_unit)
        : width_((image.width + 1) / 2),
          height_((image.height + 1) / 2),
          repeat_s_(image.repeat_x),
          repeat_t_(image.repeat_y),
          texels_per_unit_(texels_per_unit),
          mean_(mean),
          image_(image) {}

    /// Bilinear.
    Covariance at(float s, float t) const {
        analysed_([this] { analyse(); });
        const AxisTaps x = axis_taps(s, 0.5f * texels_per_unit_.x, width_, repeat_s_);
        const AxisTaps y = axis_taps(t, 0.5f * texels_per_unit_.y, height_, repeat_t_);
        Covariance sum;
        const auto add = [&](int column, int row, float weight) {
            const auto& c = cells_[size_t(row) * size_t(width_) + size_t(column)];
            sum.ss += weight * c.ss;
            sum.st += weight * c.st;
            sum.tt += weight * c.tt;
        };
        add(x.first, y.first, (1 - x.weight) * (1 - y.weight));
        add(x.second, y.first, x.weight * (1 - y.weight));
        add(x.first, y.second, (1 - x.weight) * y.weight);
        add(x.second, y.second, x.weight * y.weight);
        return sum;
    }

    size_t memory() const { return image_.memory() + cells_.size() * sizeof(Covariance); }

  private:
    void analyse() const {
        const std::vector<Level> levels = make_pyramid(image_);
        Accumulator sum{mean_};
        for (size_t i = levels.size(); i-- > 0;) sum.add(levels[i], 2);
        sum.add(levels[0], 1);
        // The narrowest window is as wide as a cell of two by two texels, so that less would tell
        // no more.
        const ScalarField ss = box_reduced(sum.ss, 2), st = box_reduced(sum.st, 2),
                          tt = box_reduced(sum.tt, 2);
        const auto [per_s, per_t] = texels_per_unit_;
        cells_.resize(ss.values.size());
        for (size_t i = 0; i < cells_.size(); ++i) {
            const Covariance c = bounded_anisotropy({ss.values[i], st.values[i], tt.values[i]});
            cells_[i] = {c.ss * sqr(per_s), c.st * per_s * per_t, c.tt * sqr(per_t)};
        }
        image_ = {};
    }

    int width_, height_;  // cells, each of two by two texels of this resolution
    bool repeat_s_, repeat_t_;
    Vec2 texels_per_unit_;
    float mean_;
    Once analysed_;
    mutable ScalarField image_;  // about the mean; empty once it is analysed
    mutable std::vector<Covariance> cells_;
};

struct ImageSpectrum::Pyramid {
    std::deque<Scale> scales;  ///< each of half the resolution of the one before
    Vec2 texels_per_unit;      ///< of the first
};

ImageSpectrum::ImageSpectrum(std::span<const float> luminance, int width, int height, Wrap wrap) {
    if (luminance.empty()) return;
    const double mean =
        std::accumulate(luminance.begin(), luminance.end(), 0.0) / double(luminance.size());
    // About the mean, because variances are differences of squares.
    ScalarField field(width, height, wrap != Wrap::clamp, wrap == Wrap::repeat);
    for (size_t i = 0; i < luminance.size(); ++i) field.values[i] = float(luminance[i] - mean);
    const int factor = (std::max(width, height) + kMaxAnalysedSize - 1) / kMaxAnalysedSize;
    if (factor > 1) field = box_reduced(field, factor);

    const auto pyramid = std::make_shared<Pyramid>();
    Vec2 per_unit{float(width) / float(factor), float(height) / float(factor)};
    pyramid->texels_per_unit = per_unit;
    for (;; per_unit = 0.5f * per_unit) {
        pyramid->scales.emplace_back(field, float(mean), per_unit);
        if (std::min(field.width, field.height) < 4) break;
        field = halved(field);
    }
    pyramid_ = pyramid;
}

SpatialCovariance2 ImageSpectrum::at(float s, float t, Vec2 footprint) const {
    if (!pyramid_) return {};
    const auto& [scales, per_unit] = *pyramid_;
    // Halving l times smooths by a deviation of half of 2^l texels: as a pixel of 2^l texels does.
    const float texels = std::min(footprint.x * per_unit.x, footprint.y * per_unit.y);
    const float level = texels > 1 ? std::min(std::log2(texels), float(scales.size() - 1)) : 0.0f;
    const auto finer = static_cast<size_t>(level);
    const float coarser_share = level - float(finer);
    const SpatialCovariance2 a = scales[finer].at(s, t);
    if (!(coarser_share > 0)) return a;
    const SpatialCovariance2 b = scales[finer + 1].at(s, t);
    const auto blend = [coarser_share](float p, float q) { return p + coarser_share * (q - p); };
    return {blend(a.ss, b.ss), blend(a.st, b.st), blend(a.tt, b.tt)};
}

size_t ImageSpectrum::memory() const {
    size_t bytes = 0;
    if (pyramid_)
        for (const Scale& s : pyramid_->scales) bytes += s.memory();
    return bytes;
}

}  // namespace covtrace
