#include "reconstruction/regression.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "reconstruction/lanes.h"
#include "reconstruction/patch_distance.h"

namespace covtrace {

namespace {

constexpr int kReach = kRegressionReach, kSide = 2 * kReach + 1;
constexpr int kBlock = PatchDistance::kBlock, kStride = 2, kPatchRadius = 1;
constexpr size_t kOffsets = size_t(kSide) * kSide;
constexpr size_t kCells = (kOffsets + kLanes - 1) / kLanes * kLanes;  // offsets, padded
constexpr size_t kPositions = 3;                                      // 1, x, y
constexpr size_t kBasis = kPositions + kFeatures;                     // and the features
constexpr size_t kCentres = size_t(kBlock / kStride) * (kBlock / kStride);
constexpr int kHaloSide = kBlock + 2 * kReach;

/// One number per pixel of a window, row by row; the padding stays 0.
using Cells = std::array<float, kCells>;

/// What one block of centres adds to the pixels it reaches: weighted colours and weights.
using Contribution = std::array<std::vector<float>, 4>;

struct Inputs {
    std::array<PaddedPlane, kFeatures> feature;
    std::array<PaddedPlane, 3> color;
    PaddedPlane inside;   // 1 in the image, 0 outside
    PaddedPlane sampled;  // 1 where a pixel has samples, 0 elsewhere and outside
    int width, height;
};

void gather(const PaddedPlane& plane, int x, int y, Cells& out) {
    for (int dy = -kReach; dy <= kReach; ++dy) {
        const float* row = plane.at(x - kReach, y + dy);
        std::copy(row, row + kSide, &out[size_t(dy + kReach) * kSide]);
    }
}

/// The positions of a window's pixels relative to its centre, in units of its reach.
struct Positions {
    Cells one{}, x{}, y{};
    Positions() {
        size_t o = 0;
        for (int dy = -kReach; dy <= kReach; ++dy)
            for (int dx = -kReach; dx <= kReach; ++dx, ++o) {
                one[o] = 1;
                x[o] = float(dx) / kReach;
                y[o] = float(dy) / kReach;
            }
    }
};

/// The window of one centre: the basis functions and colours around it.
class Window {
  public:
    void load(const Inputs& in, int x, int y) {
        for (size_t f = 0; f < kFeatures; ++f) {
            gather(in.feature[f], x, y, feature_[f]);
            const float centre = feature_[f][kOffsets / 2];
            for (size_t o = 0; o < kOffsets; ++o) feature_[f][o] -= centre;
        }
        for (size_t c = 0; c < 3; ++c) gather(in.color[c], x, y, color_[c]);
        gather(in.inside, x, y, inside_);
        gather(in.sampled, x, y, sampled_);
    }
    const Cells& inside() const { return inside_; }

    /// Fits the colours with the weights and writes the fit's value at every pixel. False where
    /// there is nothing to fit.
    bool fit(const Cells& weight, std::array<Cells, 3>& fitted) {
        solve_normal_equations(weight);
        if (!(total_ > 0)) return false;
        for (size_t c = 0; c < 3; ++c) {
            Cells& out = fitted[c];
            const float b0 = coefficient_[c][0];
            for (size_t o = 0; o < kCells; ++o) out[o] = b0;
            for (size_t i = 1; i < kBasis; ++i) {
                const float b = coefficient_[c][i];
                const Cells& x = *basis_[i];
                for (size_t o = 0; o < kCells; ++o) out[o] += b * x[o];
            }
        }
        return true;
    }

  private:
    void solve_normal_equations(const Cells& weight) {
        constexpr size_t n = kBasis;
        for (size_t i = 0; i < n; ++i) {
            const Cells& x = *basis_[i];
            Cells& z = weighted_[i];
            for (size_t o = 0; o < kCells; ++o) z[o] = weight[o] * sampled_[o] * x[o];
        }
        // Columns beyond the basis: the colours.
        std::array<const float*, kBasis + 3> column{};
        for (size_t i = 0; i < n; ++i) column[i] = basis_[i]->data();
        for (size_t c = 0; c < 3; ++c) column[n + c] = color_[c].data();
        double a[kBasis][kBasis + 3];
        for (size_t i = 0; i < n; i += 2) {
            const size_t next = std::min(i + 1, n - 1);
            const float* const rows[2] = {weighted_[i].data(), weighted_[next].data()};
            for (size_t j = i; j < n + 3; j += 4) {
                const auto at = [&](size_t k) { return column[std::min(j + k, n + 2)]; };
                const float* const columns[4] = {at(0), at(1), at(2), at(3)};
                float sums[2][4];
                products(rows, columns, kCells, sums);
                for (size_t k = 0; k < 4 && j + k < n + 3; ++k) {
                    a[i][j + k] = double(sums[0][k]);
                    a[next][j + k] = double(sums[1][k]);
                }
            }
        }
        total_ = float(a[0][0]);
        if (!(total_ > 0)) return;
        // The ridge, relative to each function's own spread, and a floor below which a feature
        // counts as constant: what differs by less is rounding and left-over noise.
        constexpr double kRidge = 1e-3, kFloor = 1e-5;
        for (size_t i = 1; i < n; ++i) a[i][i] += kRidge * a[i][i] + kFloor * a[0][0];
        eliminate(a);
    }

    /// Gauss elimination of the symmetric positive definite system; only its upper half is read.
    void eliminate(double (&a)[kBasis][kBasis + 3]) {
        constexpr size_t n = kBasis;
        for (size_t i = 0; i < n; ++i) {
            const double inverse = 1 / a[i][i];
            for (size_t r = i + 1; r < n; ++r) {
                const double factor = a[i][r] * inverse;
                for (size_t j = r; j < n + 3; ++j) a[r][j] -= factor * a[i][j];
            }
        }
        for (size_t c = 0; c < 3; ++c)
            for (size_t i = n; i-- > 0;) {
                double sum = a[i][n + c];
                for (size_t j = i + 1; j < n; ++j) sum -= a[i][j] * double(coefficient_[c][j]);
                coefficient_[c][i] = float(sum / a[i][i]);
            }
    }

    const Positions positions_;
    std::array<Cells, kFeatures> feature_{};
    std::array<Cells, 3> color_{};
    Cells inside_{}, sampled_{};
    const std::array<const Cells*, kBasis> basis_ = [this] {
        std::array<const Cells*, kBasis> b{&positions_.one, &positions_.x, &positions_.y};
        for (size_t f = 0; f < kFeatures; ++f) b[kPositions + f] = &feature_[f];
        return b;
    }();
    std::array<Cells, kBasis> weighted_{};
    float total_ = 0;
    float coefficient_[3][kBasis] = {};
};

/// The weights of all pixels around the centre (x, y).
void set_weights(const RegressionWindow& window, const float* distance, const Cells& inside, int x,
                 int y, Cells& weight) {
    const float scale = 1 / (window.k * window.k);
    for (size_t o = 0; o < kOffsets; ++o) weight[o] = inside[o] * patch_weight(scale * distance[o]);
    if (!window.shape) return;
    const auto& s = window.shape->covariance[size_t(y) * size_t(window.shape->width) + size_t(x)];
    const float norm = 0.5f / ((s.xx * s.yy - s.xy * s.xy) * window.widen * window.widen);
    const float qxx = s.yy * norm, qxy = -s.xy * norm, qyy = s.xx * norm;
    size_t o = 0;
    for (int dy = -kReach; dy <= kReach; ++dy)
        for (int dx = -kReach; dx <= kReach; ++dx, ++o)
            weight[o] *=
                std::exp(-(qxx * float(dx * dx) + 2 * qxy * float(dx * dy) + qyy * float(dy * dy)));
}

/// All centres of one block, for every window.
class Block {
  public:
    Block(const Inputs& in, const PatchDistance& distance,
          std::span<const RegressionWindow> windows)
        : in_(in), distance_(distance), windows_(windows) {}

    void run(int x0, int y0, std::span<Contribution> out) {
        for (Contribution& c : out)
            for (auto& plane : c) plane.assign(size_t(kHaloSide) * kHaloSide, 0.0f);
        collect_distances(x0, y0);
        for (int y = 0; y < kBlock && y0 + y < in_.height; y += kStride)
            for (int x = 0; x < kBlock && x0 + x < in_.width; x += kStride) {
                window_.load(in_, x0 + x, y0 + y);
                const float* d =
                    &distances_[(size_t(y / kStride) * (kBlock / kStride) + size_t(x / kStride)) *
                                kOffsets];
                for (size_t k = 0; k < windows_.size(); ++k) {
                    set_weights(windows_[k], d, window_.inside(), x0 + x, y0 + y, weight_);
                    if (window_.fit(weight_, fitted_)) add(x, y, out[k]);
                }
            }
    }

  private:
    void collect_distances(int x0, int y0) {
        distances_.resize(kCentres * kOffsets);
        std::array<float, size_t(kBlock) * kBlock> d;
        size_t o = 0;
        for (int dy = -kReach; dy <= kReach; ++dy)
            for (int dx = -kReach; dx <= kReach; ++dx, ++o) {
                distance_.block(x0, y0, dx, dy, d.data());
                size_t centre = 0;
                for (size_t y = 0; y < kBlock; y += kStride)
                    for (size_t x = 0; x < kBlock; x += kStride, ++centre)
                        distances_[centre * kOffsets + o] = d[y * kBlock + x];
            }
    }

    void add(int x, int y, Contribution& out) const {
        for (int row = 0; row < kSide; ++row) {
            const size_t to = size_t(y + row) * kHaloSide + size_t(x), from = size_t(row) * kSide;
            for (size_t k = 0; k < kSide; ++k) {
                const float w = weight_[from + k];
                for (size_t c = 0; c < 3; ++c) out[c][to + k] += w * fitted_[c][from + k];
                out[3][to + k] += w;
            }
        }
    }

    const Inputs& in_;
    const PatchDistance& distance_;
    std::span<const RegressionWindow> windows_;
    Window window_;
    Cells weight_{};
    std::array<Cells, 3> fitted_{};
    std::vector<float> distances_;  // centre by centre
};

}  // namespace

std::vector<ColorPlanes> regress(const HalfBuffer& half, const HalfBuffer& guide,
                                 const FeaturePlanes& features,
                                 std::span<const RegressionWindow> windows) {
    const int w = half.count.width, h = half.count.height;
    Inputs in;
    in.width = w;
    in.height = h;
    for (size_t f = 0; f < kFeatures; ++f) in.feature[f] = PaddedPlane(features[f], kReach);
    for (size_t c = 0; c < 3; ++c) in.color[c] = PaddedPlane(half.color[c], kReach);
    Plane sampled(w, h);
    for (size_t i = 0; i < sampled.size(); ++i) sampled[i] = half.count[i] > 0 ? 1.0f : 0.0f;
    in.sampled = PaddedPlane(sampled, kReach, 0);
    in.inside = PaddedPlane(Plane(w, h, 1), kReach, 0);
    const PatchDistance distance(guide.color, guide.color_variance, kReach, kPatchRadius);

    const int blocks_x = (w + kBlock - 1) / kBlock, blocks_y = (h + kBlock - 1) / kBlock;
    std::vector<std::vector<Contribution>> contributions(size_t(blocks_x) * size_t(blocks_y),
                                                         std::vector<Contribution>(windows.size()));
    parallel_for(int64_t(contributions.size()), [&](int64_t b) {
        Block(in, distance, windows)
            .run(int(b % blocks_x) * kBlock, int(b / blocks_x) * kBlock, contributions[size_t(b)]);
    });

    std::vector<ColorPlanes> result(windows.size());
    for (ColorPlanes& planes : result) planes.fill(Plane(w, h));
    parallel_for(h, [&](int64_t row) {
        const int y = int(row);
        for (size_t k = 0; k < windows.size(); ++k)
            for (int x = 0; x < w; ++x) {
                // The blocks that reach this pixel, in a fixed order.
                std::array<float, 4> sum{};
                for (int by = std::max(0, (y - kReach) / kBlock);
                     by <= std::min(blocks_y - 1, (y + kReach) / kBlock); ++by)
                    for (int bx = std::max(0, (x - kReach) / kBlock);
                         bx <= std::min(blocks_x - 1, (x + kReach) / kBlock); ++bx) {
                        const size_t at = size_t(y - by * kBlock + kReach) * kHaloSide +
                                          size_t(x - bx * kBlock + kReach);
                        const Contribution& part =
                            contributions[size_t(by) * size_t(blocks_x) + size_t(bx)][k];
                        for (size_t c = 0; c < 4; ++c) sum[c] += part[c][at];
                    }
                for (size_t c = 0; c < 3; ++c)
                    result[k][c](x, y) = sum[3] > 0 ? sum[c] / sum[3] : half.color[c](x, y);
            }
    });
    return result;
}

}  // namespace covtrace
