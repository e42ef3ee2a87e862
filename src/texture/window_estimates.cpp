#include "texture/window_estimates.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/vec.h"

namespace covtrace {
namespace {

using Covariance = SpatialCovariance2;

/// Contrast, standard deviation over mean, from which on a structure counts in full.
constexpr float kFullContrast = 0.1f;
/// Least mean that contrasts are measured against, as a share of the image's mean.
constexpr float kDarkest = 0.01f;
/// Least variance about the trend, as a share of the whole variance: it is a difference, and less
/// would be rounding.
constexpr float kMinDetrended = 0.03f;

/// Columns of the field that those of a rectangle read, `shift` further on; the rectangle may reach
/// beyond the field.
std::vector<int> columns_of(const ScalarField& field, CellRect rect, int shift) {
    std::vector<int> columns(size_t(rect.width()));
    for (int x = rect.x0; x < rect.x1; ++x)
        columns[size_t(x - rect.x0)] = field.column_index(field.column_index(x) + shift);
    return columns;
}

/// A copy of map(value) for all cells of a rectangle, which may reach beyond the field.
template <typename Map>
ScalarField copied(const ScalarField& field, CellRect rect, const Map& map) {
    ScalarField copy(rect.width(), rect.height(), false, false);
    const std::vector<int> columns = columns_of(field, rect, 0);
    for (int y = 0; y < copy.height; ++y) {
        const float* from = field.row(field.row_index(rect.y0 + y));
        float* to = copy.row(y);
        for (size_t i = 0; i < columns.size(); ++i) to[i] = map(from[columns[i]]);
    }
    return copy;
}

/// Products of the components of the gradient at each cell, per cell^2.
struct GradientProducts {
    ScalarField xx, xy, yy;
};

/// Means of gradient products over the four corners of each cell. A corner's gradient is centred
/// alike in x and y, so that a straight edge has one direction; but it doesn't see a checkerboard
/// of single cells, which only the finest level can hold: there half of it is plain differences.
GradientProducts gradient_products(const ScalarField& f, float spacing, CellRect rect) {
    const ScalarField empty(rect.width(), rect.height(), false, false);
    GradientProducts out{empty, empty, empty};
    const float per_texel2 = 1 / (spacing * spacing);
    const float plain = spacing > 1 ? 0.0f : 0.5f;
    const auto width = size_t(rect.width());
    std::array<std::vector<int>, 3> columns;
    for (int i = 0; i < 3; ++i) columns[size_t(i)] = columns_of(f, rect, i - 1);
    // The 3 x 3 neighbours of a row's cells: v[row][column] points into the field itself, or to a
    // copy where the rectangle reaches the field's border.
    std::array<std::array<const float*, 3>, 3> v{};
    std::array<std::array<std::vector<float>, 3>, 3> copies;
    const bool is_inside = rect.x0 > 0 && rect.x1 < f.width;
    for (int y = 0; y < rect.height(); ++y) {
        for (int j = 0; j < 3; ++j) {
            const float* from = f.row(f.row_index(f.row_index(rect.y0 + y) + j - 1));
            for (int i = 0; i < 3; ++i) {
                if (is_inside) {
                    v[size_t(j)][size_t(i)] = from + rect.x0 + i - 1;
                    continue;
                }
                std::vector<float>& copy = copies[size_t(j)][size_t(i)];
                copy.resize(width);
                for (size_t x = 0; x < width; ++x) copy[x] = from[columns[size_t(i)][x]];
                v[size_t(j)][size_t(i)] = copy.data();
            }
        }
        float *to_xx = out.xx.row(y), *to_xy = out.xy.row(y), *to_yy = out.yy.row(y);
        for (size_t x = 0; x < width; ++x) {
            float xx = 0, xy = 0, yy = 0;
            for (size_t j = 0; j < 2; ++j)
                for (size_t i = 0; i < 2; ++i) {
                    const float a = v[j][i][x], b = v[j][i + 1][x];
                    const float c = v[j + 1][i][x], d = v[j + 1][i + 1][x];
                    const float gx = 0.5f * (b - a + d - c), gy = 0.5f * (c - a + d - b);
                    xx += 0.25f * gx * gx;
                    xy += 0.25f * gx * gy;
                    yy += 0.25f * gy * gy;
                }
            to_xx[x] = xx * per_texel2;
            to_xy[x] = xy * per_texel2;
            to_yy[x] = yy * per_texel2;
        }
        if (!(plain > 0)) continue;
        for (size_t x = 0; x < width; ++x) {
            const float value = v[1][1][x];
            const auto square = [&](float neighbour) { return 0.5f * sqr(neighbour - value); };
            to_xx[x] += plain * (square(v[1][0][x]) + square(v[1][2][x]) - to_xx[x]);
            to_yy[x] += plain * (square(v[0][1][x]) + square(v[2][1][x]) - to_yy[x]);
        }
    }
    return out;
}

/// The estimate of one window (see image_spectrum.h) from the covariance `c` of the gradient in it.
Covariance estimate(Covariance c, float variance, float mean, float window) {
    if (!(variance > 0)) return {};
    const float trace = c.ss + c.tt;
    const float visible = std::min(1.0f, variance / sqr(kFullContrast * mean));
    const float resolved = std::min(1.0f, window * window * trace / variance);
    const float f = visible * resolved / (2 * kPi * kPi * variance);
    const float limit = std::sqrt(c.ss * c.tt);
    return {f * c.ss, f * std::clamp(c.st, -limit, limit), f * c.tt};
}

/// The tiles that look-ups read, in order.
std::vector<int> tiles_of(const std::vector<Between>& look_ups) {
    std::vector<int> tiles;
    for (const Between& l : look_ups)
        for (const int cell : {l.first, l.second}) tiles.push_back(cell / WindowEstimates::kTile);
    std::sort(tiles.begin(), tiles.end());
    tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
    return tiles;
}

}  // namespace

WindowEstimates::WindowEstimates(const ScalarField& value, ScalarField square, float spacing,
                                 float image_mean, std::vector<float> windows,
                                 const WindowEstimates* coarser)
    : value_(value),
      square_(std::move(square)),
      spacing_(spacing),
      image_mean_(image_mean),
      windows_(std::move(windows)),
      coarser_(coarser),
      tiles_x_((value.width + kTile - 1) / kTile),
      made_(std::make_unique<std::once_flag[]>(size_t(tiles_x_) *
                                               size_t((value.height + kTile - 1) / kTile))),
      cells_(std::make_unique_for_overwrite<WindowEstimate[]>(value.values.size())) {}

void WindowEstimates::need_tile(int tile_x, int tile_y) const {
    std::call_once(made_[size_t(tile_y) * size_t(tiles_x_) + size_t(tile_x)],
                   [&] { make_tile(tile_x, tile_y); });
}

void WindowEstimates::make_tile(int tile_x, int tile_y) const {
    const CellRect rect{tile_x * kTile, tile_y * kTile,
                        std::min(value_.width, (tile_x + 1) * kTile),
                        std::min(value_.height, (tile_y + 1) * kTile)};
    const std::vector<WindowEstimate> made = of(rect);
    cells_made_ += made.size();
    for (int y = rect.y0; y < rect.y1; ++y)
        std::copy_n(made.begin() + std::ptrdiff_t(y - rect.y0) * rect.width(), rect.width(),
                    cells_.get() + size_t(y) * size_t(value_.width) + rect.x0);
}

std::vector<WindowEstimate> WindowEstimates::doubled_coarser(CellRect rect) const {
    const ScalarField &f = value_, &half = coarser_->value_;
    std::vector<Between> columns, rows;
    for (int x = rect.x0; x < rect.x1; ++x)
        columns.push_back(between(x, f.width, half.width, f.repeat_x));
    for (int y = rect.y0; y < rect.y1; ++y)
        rows.push_back(between(y, f.height, half.height, f.repeat_y));
    const std::vector<int> tiles_x = tiles_of(columns);
    for (const int tile_y : tiles_of(rows))
        for (const int tile_x : tiles_x) coarser_->need_tile(tile_x, tile_y);

    std::vector<WindowEstimate> result;
    result.reserve(columns.size() * rows.size());
    for (const Between& row : rows) {
        const auto row_of = [&](int y) {
            return coarser_->cells_.get() + size_t(y) * size_t(half.width);
        };
        const WindowEstimate *above = row_of(row.first), *below = row_of(row.second);
        for (const Between& column : columns) {
            const WindowEstimate &a = above[column.first], &b = above[column.second],
                                 &c = below[column.first], &d = below[column.second];
            const auto mean = [&](const auto& of) {
                const float upper = of(a) + column.weight * (of(b) - of(a));
                const float lower = of(c) + column.weight * (of(d) - of(c));
                return upper + row.weight * (lower - upper);
            };
            result.push_back({mean([](const WindowEstimate& e) { return e.variance; }),
                              {mean([](const WindowEstimate& e) { return e.largest.ss; }),
                               mean([](const WindowEstimate& e) { return e.largest.st; }),
                               mean([](const WindowEstimate& e) { return e.largest.tt; })}});
        }
    }
    return result;
}

std::vector<WindowEstimate> WindowEstimates::of(CellRect rect) const {
    std::vector<WindowEstimate> sum;
    if (coarser_) sum = doubled_coarser(rect);
    const bool is_widest = sum.empty();
    if (is_widest) sum.resize(size_t(rect.width()) * size_t(rect.height()));
    // The halo is one cell more than the window: slopes need the windowed mean beside each cell,
    // too.
    const int halo = GaussianWindow(windows_.front()).radius + 1;
    const CellRect seen{rect.x0 - halo, rect.y0 - halo, rect.x1 + halo, rect.y1 + halo};
    const GradientProducts g = gradient_products(value_, spacing_, seen);
    const ScalarField value = copied(value_, seen, [](float v) { return v; });
    const ScalarField square = square_.values.empty()
                                   ? copied(value_, seen, [](float v) { return v * v; })
                                   : copied(square_, seen, [](float v) { return v; });
    for (size_t k = 0; k < windows_.size(); ++k) {
        const GaussianWindow window(windows_[k]);
        const ScalarField mean = smooth_inside(value, window),
                          second = smooth_inside(square, window), xx = smooth_inside(g.xx, window),
                          xy = smooth_inside(g.xy, window), yy = smooth_inside(g.yy, window);
        // The window's variance per axis in texels: its own and that of the filters before it.
        const float spacing2 = spacing_ * spacing_;
        const float spread = window.variance * spacing2 + 0.25f * (spacing2 - 1);
        const int x0 = rect.x0 - halo + window.radius, y0 = rect.y0 - halo + window.radius;
        // The mean outside of a field that does not repeat is that of its border.
        const auto column = [&](int x) {
            return (value_.repeat_x ? x : std::clamp(x, 0, value_.width - 1)) - x0;
        };
        const auto row = [&](int y) {
            return (value_.repeat_y ? y : std::clamp(y, 0, value_.height - 1)) - y0;
        };
        WindowEstimate* at = sum.data();
        for (int y = rect.y0; y < rect.y1; ++y) {
            const float *above = mean.row(row(y - 1)), *level = mean.row(y - y0),
                        *below = mean.row(row(y + 1));
            for (int x = rect.x0; x < rect.x1; ++x, ++at) {
                const int i = x - x0;
                // The gradient of the windowed mean is the mean gradient, and the slope of the
                // regression line in a Gaussian window (Stein's lemma).
                const float gx = 0.5f * (level[column(x + 1)] - level[column(x - 1)]) / spacing_;
                const float gy = 0.5f * (below[i] - above[i]) / spacing_;
                const float all = std::max(0.0f, second.row(y - y0)[i] - level[i] * level[i]);
                const float variance =
                    std::max(kMinDetrended * all, all - spread * (gx * gx + gy * gy));
                const Covariance c{std::max(0.0f, xx.row(y - y0)[i] - gx * gx),
                                   xy.row(y - y0)[i] - gx * gy,
                                   std::max(0.0f, yy.row(y - y0)[i] - gy * gy)};
                // A window alone underestimates the variance of waves longer than itself.
                const bool widest = is_widest && k == 0;
                const Covariance e =
                    estimate(c, widest ? variance : std::max(variance, at->variance),
                             std::max(level[i] + image_mean_, kDarkest * std::abs(image_mean_)),
                             windows_[k] * spacing_);
                if (e.ss + e.tt > at->largest.ss + at->largest.tt) at->largest = e;
                at->variance = variance;
            }
        }
    }
    return sum;
}

size_t WindowEstimates::memory() const {
    return square_.memory() + cells_made_ * sizeof(WindowEstimate);
}

}  // namespace covtrace
