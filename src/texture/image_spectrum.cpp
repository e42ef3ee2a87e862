#include "texture/image_spectrum.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <deque>
#include <memory>
#include <mutex>
#include <vector>

#include "core/once.h"
#include "texture/scalar_field.h"
#include "texture/window_estimates.h"

namespace covtrace {
namespace {

/// Least ratio of the smaller to the larger eigenvalue: structures bend, so that none is as long as
/// its straight part makes it look.
constexpr float kMinEigenvalueRatio = 0.1f;
using Covariance = SpatialCovariance2;  // in cycles^2 per analysed texel^2 within this file

/// Raises the smaller eigenvalue to kMinEigenvalueRatio of the larger one.
Covariance bounded_anisotropy(Covariance c) {
    const float half_trace = 0.5f * (c.ss + c.tt);
    const float radius = std::sqrt(0.25f * sqr(c.ss - c.tt) + c.st * c.st);
    const float larger = half_trace + radius, smaller = half_trace - radius;
    const float missing = kMinEigenvalueRatio * larger - smaller;
    if (!(missing > 0)) return c;
    const float f = missing / (larger - smaller);
    return {c.ss + f * (larger - c.ss), c.st - f * c.st, c.tt + f * (larger - c.tt)};
}

/// Index range of a bilinear lookup on an axis of n cells; any float gives valid indices.
struct AxisTaps {
    int first = 0, second = 0;
    float weight = 0;
};
inline AxisTaps axis_taps(float coordinate, float cells_per_unit, int n, bool repeats) {
    float c = repeats ? coordinate - std::floor(coordinate) : coordinate;
    c = c > 0 ? std::min(c, 1.0f) : 0.0f;
    const float x = c * cells_per_unit - 0.5f;
    const float below = std::floor(x);
    // Bilinear taps lie at most one cell beyond either end of the axis.
    const int first = std::min(int(below), n - 1), second = first + 1;
    return {first >= 0 ? first : (repeats ? n - 1 : 0), second < n ? second : (repeats ? 0 : n - 1),
            x - below};
}

}  // namespace

/// The image at one resolution and, where it was looked up, its analysis.
class ImageSpectrum::Scale {
  public:
    /// `values`: this resolution about the mean and all coarser ones, which outlive this.
    Scale(std::span<const ScalarField> values, float mean, Vec2 texels_per_unit)
        : values_(values),
          width_((values[0].width + 1) / 2),
          height_((values[0].height + 1) / 2),
          texels_per_unit_(texels_per_unit),
          mean_(mean) {}

    /// The covariance around (s, t), interpolated bilinearly between cells; analyses the cells that
    /// it needs.
    Covariance at(float s, float t) const {
        prepared_([this] { prepare(); });
        const ScalarField& image = values_[0];
        const AxisTaps x = axis_taps(s, 0.5f * texels_per_unit_.x, width_, image.repeat_x);
        const AxisTaps y = axis_taps(t, 0.5f * texels_per_unit_.y, height_, image.repeat_y);
        const auto tile = [](int cell) { return int(unsigned(cell) / unsigned(kTile)); };
        const int tile_x = tile(x.first), tile_y = tile(y.first), second_x = tile(x.second),
                  second_y = tile(y.second);
        need_tile(tile_x, tile_y);
        if (second_x != tile_x || second_y != tile_y) {
            need_tile(second_x, tile_y);
            need_tile(tile_x, second_y);
            need_tile(second_x, second_y);
        }
        using Float4 __attribute__((vector_size(16))) = float;
        const auto cell = [&](int column, int row) {
            const Covariance& c = cells_[size_t(row) * size_t(width_) + size_t(column)];
            return Float4{c.ss, c.st, c.tt, 0};
        };
        const Float4 sum = cell(x.first, y.first) * ((1 - x.weight) * (1 - y.weight)) +
                           cell(x.second, y.first) * (x.weight * (1 - y.weight)) +
                           cell(x.first, y.second) * ((1 - x.weight) * y.weight) +
                           cell(x.second, y.second) * (x.weight * y.weight);
        return {sum[0], sum[1], sum[2]};
    }

    size_t memory() const {
        size_t bytes = texels_made_ / 4 * sizeof(Covariance);
        for (const WindowEstimates& level : levels_) bytes += level.memory();
        return bytes;
    }

  private:
    /// Side of the tiles that are analysed at once, in cells of two by two texels.
    static constexpr int kTile = WindowEstimates::kTile / 2;
    struct Tile {
        std::once_flag once;
        std::atomic<bool> is_made{false};  // whether `once` is done, cheaper to ask
    };

    void prepare() const {
        std::vector<ScalarField> squares{values_[0]};
        for (float& v : squares[0].values) v *= v;
        for (size_t i = 1; i < values_.size(); ++i) squares.push_back(halved(squares.back()));
        squares[0] = {};
        levels_.clear();  // left over from an attempt that threw
        const WindowEstimates* coarser = nullptr;
        for (size_t i = values_.size(); i-- > 0;) {
            std::vector<float> windows{2};
            // The finest level needs no window narrower than a cell of two by two texels: such a
            // one would tell no more.
            if (i == 0) windows.push_back(1);
            coarser = &levels_.emplace_front(values_[i], std::move(squares[i]),
                                             float(uint64_t{1} << i), mean_, windows, coarser);
        }
        tiles_x_ = (width_ + kTile - 1) / kTile;
        tiles_ = std::make_unique<Tile[]>(size_t(tiles_x_) * size_t((height_ + kTile - 1) / kTile));
        cells_ = std::make_unique_for_overwrite<Covariance[]>(size_t(width_) * size_t(height_));
    }

    void need_tile(int tile_x, int tile_y) const {
        Tile& tile = tiles_[size_t(tile_y) * size_t(tiles_x_) + size_t(tile_x)];
        if (tile.is_made.load(std::memory_order_acquire)) return;
        std::call_once(tile.once, [&] {
            make_tile(tile_x, tile_y);
            tile.is_made.store(true, std::memory_order_release);
        });
    }

    void make_tile(int tile_x, int tile_y) const {
        const int texels = 2 * kTile;
        const ScalarField& image = values_[0];
        const CellRect rect{tile_x * texels, tile_y * texels,
                            std::min(image.width, (tile_x + 1) * texels),
                            std::min(image.height, (tile_y + 1) * texels)};
        const std::vector<WindowEstimate> found = levels_.front().of(rect);
        texels_made_ += found.size();
        const auto [per_s, per_t] = texels_per_unit_;
        for (int y = rect.y0; y < rect.y1; y += 2)
            for (int x = rect.x0; x < rect.x1; x += 2) {
                double ss = 0, st = 0, tt = 0;
                int count = 0;
                for (int j = y; j < std::min(y + 2, rect.y1); ++j)
                    for (int i = x; i < std::min(x + 2, rect.x1); ++i, ++count) {
                        const WindowEstimate& e =
                            found[size_t(j - rect.y0) * size_t(rect.width()) + size_t(i - rect.x0)];
                        ss += double(e.largest.ss);
                        st += double(e.largest.st);
                        tt += double(e.largest.tt);
                    }
                const Covariance c =
                    bounded_anisotropy({float(ss / count), float(st / count), float(tt / count)});
                cells_[size_t(y / 2) * size_t(width_) + size_t(x / 2)] = {
                    c.ss * sqr(per_s), c.st * per_s * per_t, c.tt * sqr(per_t)};
            }
    }

    std::span<const ScalarField> values_;
    int width_, height_;  // cells
    Vec2 texels_per_unit_;
    float mean_;
    Once prepared_;
    mutable std::deque<WindowEstimates> levels_;  // from the finest on
    mutable int tiles_x_ = 0;
    mutable std::unique_ptr<Tile[]> tiles_;
    mutable std::atomic<size_t> texels_made_{0};
    mutable std::unique_ptr<Covariance[]> cells_;  // touched only where tiles are made
};

struct ImageSpectrum::Pyramid {
    /// Luminance about the mean, each of half the resolution of the last.
    std::vector<ScalarField> values;
    /// Analysis by resolution: the first of all `values`, the next without the finest.
    std::deque<Scale> scales;
    Vec2 texels_per_unit;  ///< texels of the finest resolution per unit of s and t
};

ImageSpectrum::ImageSpectrum(std::span<const float> luminance, int width, int height, Wrap wrap) {
    if (!luminance.empty())
        *this = {[luminance](size_t i) { return luminance[i]; }, width, height, wrap};
}

ImageSpectrum::ImageSpectrum(const std::function<float(size_t)>& luminance, int width, int height,
                             Wrap wrap) {
    const size_t texels = size_t(width) * size_t(height);
    double sum = 0;
    for (size_t i = 0; i < texels; ++i) sum += double(luminance(i));
    const double mean = sum / double(texels);
    const int factor = (std::max(width, height) + kMaxAnalysedSize - 1) / kMaxAnalysedSize;
    // Values are taken about the mean, because variances are differences of squares.
    const bool repeats_s = wrap == Wrap::repeat || wrap == Wrap::repeat_s;
    const bool repeats_t = wrap == Wrap::repeat || wrap == Wrap::repeat_t;
    ScalarField field = box_reduced([&](size_t i) { return float(luminance(i) - mean); }, width,
                                    height, repeats_s, repeats_t, factor);

    const auto pyramid = std::make_shared<Pyramid>();
    Vec2 per_unit{float(width) / float(factor), float(height) / float(factor)};
    pyramid->texels_per_unit = per_unit;
    std::vector<ScalarField>& values = pyramid->values;
    values.push_back(std::move(field));
    while (std::max(values.back().width, values.back().height) > 2)
        values.push_back(halved(values.back()));
    for (size_t i = 0; i < values.size(); ++i, per_unit = 0.5f * per_unit) {
        pyramid->scales.emplace_back(std::span(values).subspan(i), float(mean), per_unit);
        if (std::min(values[i].width, values[i].height) < 4) break;
    }
    pyramid_ = pyramid;
}

SpatialCovariance2 ImageSpectrum::at(float s, float t, Vec2 footprint) const {
    if (!pyramid_) return {};
    const std::deque<Scale>& scales = pyramid_->scales;
    const Vec2 per_unit = pyramid_->texels_per_unit;
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
    if (!pyramid_) return bytes;
    for (const ScalarField& f : pyramid_->values) bytes += f.memory();
    for (const Scale& s : pyramid_->scales) bytes += s.memory();
    return bytes;
}

}  // namespace covtrace
