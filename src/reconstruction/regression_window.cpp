#include "reconstruction/regression_window.h"
#include "reconstruction/products.h"

#include <algorithm>
#include <cstring>

namespace covtrace {

namespace {

/// Copies the rows [begin, end) of the window around a pixel.
void cut_out(const PaddedPlane& plane, int x, int y, int begin, int end, FitWindow::Cells& out) {
    constexpr int kReach = FitWindow::kReach, kSide = FitWindow::kSide;
    for (int k = begin; k < end; ++k) {
        const float* row = plane.at(x - kReach, y + k - kReach);
        std::memcpy(&out[size_t(k) * kSide], row, kSide * sizeof(float));
    }
}

/// Copies the rows of a window from a plane without a border: its outermost pixels are repeated.
void cut_out(const Plane& plane, int x, int y, int begin, int end, FitWindow::Cells& out) {
    constexpr int kReach = FitWindow::kReach, kSide = FitWindow::kSide;
    const bool inside = x >= kReach && x + kReach < plane.width;
    float* to = &out[size_t(begin) * kSide];
    for (int v = y - kReach + begin; v < y - kReach + end; ++v, to += kSide) {
        const float* row =
            &plane.values[size_t(std::clamp(v, 0, plane.height - 1)) * size_t(plane.width)];
        if (inside) {
            std::memcpy(to, row + (x - kReach), kSide * sizeof(float));
            continue;
        }
        for (int k = 0; k < kSide; ++k) to[k] = row[std::clamp(x - kReach + k, 0, plane.width - 1)];
    }
}

}  // namespace

RegressionInputs::RegressionInputs(const HalfBuffer& half, const FeaturePlanes& features)
    : noisy(half.feature) {
    constexpr int kReach = FitWindow::kReach;
    const int w = half.count.width, h = half.count.height;
    for (size_t f = 0; f < kFeatures; ++f) filtered[f] = PaddedPlane(features[f], kReach);
    for (size_t c = 0; c < 3; ++c) color[c] = PaddedPlane(half.color[c], kReach);
    Plane has_samples(w, h);
    for (size_t i = 0; i < has_samples.size(); ++i)
        has_samples[i] = half.count[i] > 0 ? 1.0f : 0.0f;
    sampled = PaddedPlane(has_samples, kReach, 0);
    inside = PaddedPlane(Plane(w, h, 1), kReach, 0);
}

FitWindow::FitWindow() {
    size_t o = 0;
    for (int dy = -kReach; dy <= kReach; ++dy)
        for (int dx = -kReach; dx <= kReach; ++dx, ++o) {
            one_[o] = 1;
            x_[o] = float(dx) / kReach;
            y_[o] = float(dy) / kReach;
        }
    for (Basis& basis : basis_) {
        basis.function = {&one_, &x_, &y_};
        for (size_t f = 0; f < kFeatures; ++f) basis.function[kPositions + f] = &basis.feature[f];
    }
}

void FitWindow::move_to(const RegressionInputs& in, int x, int y) {
    first_row_ = std::max(0, kReach - y);
    end_row_ = std::min(kSide, in.noisy[0].height - y + kReach);
    first_ = size_t(first_row_) * kSide / kLanes * kLanes;
    end_ = (size_t(end_row_) * kSide + kLanes - 1) / kLanes * kLanes;
    const int begin = int(first_) / kSide, end = std::min(kSide, int(end_ + kSide - 1) / kSide);
    const auto explain_by = [&](FeatureNoise noise, const auto& planes) {
        Basis& basis = basis_[size_t(noise)];
        basis.size = kPositions;
        for (const auto& plane : planes) {
            Cells& feature = basis.feature[basis.size - kPositions];
            cut_out(plane, x, y, begin, end, feature);
            if (centre(feature)) ++basis.size;
        }
    };
    explain_by(FeatureNoise::filtered, in.filtered);
    explain_by(FeatureNoise::kept, in.noisy);
    for (size_t c = 0; c < 3; ++c) cut_out(in.color[c], x, y, begin, end, color_[c]);
    cut_out(in.inside, x, y, begin, end, inside_);
    cut_out(in.sampled, x, y, begin, end, sampled_);
}

void FitWindow::set_weights(const RegressionWindow& window, const float* distance, int x, int y,
                            Cells& weight) const {
    const float scale = 1 / (window.k * window.k);
    for (size_t o = first_; o < end_; o += kLanes)
        store8(load8(&inside_[o]) * patch_weight(scale * load8(distance + o)), &weight[o]);
    if (!window.shape) return;
    const FilterField& field = *window.shape;
    const auto& s = field.covariance[size_t(y) * size_t(field.width) + size_t(x)];
    const float norm =
        -0.5f * kReach * kReach / ((s.xx * s.yy - s.xy * s.xy) * window.widen * window.widen);
    const float qxx = s.yy * norm, qxy = -2 * s.xy * norm, qyy = s.xx * norm;
    for (size_t o = first_; o < end_; o += kLanes) {
        const Float8 dx = load8(&x_[o]), dy = load8(&y_[o]);
        const Float8 power = multiply_add(dx, qxx * dx + qxy * dy, qyy * (dy * dy));
        store8(load8(&weight[o]) * exp_of_negative(power), &weight[o]);
    }
}

bool FitWindow::fit(FeatureNoise noise, const Cells& weight, std::array<Cells, 3>& fitted) {
    const Basis& basis = basis_[size_t(noise)];
    solve_normal_equations(basis, weight);
    if (!(total_ > 0)) return false;
    for (size_t o = first_; o < end_; o += kLanes) {
        Float8 sum[3];
        for (size_t c = 0; c < 3; ++c) sum[c] = coefficient_[c][0] - Float8{};
        for (size_t i = 1; i < basis.size; ++i) {
            const Float8 x = load8(&(*basis.function[i])[o]);
            for (size_t c = 0; c < 3; ++c)
                sum[c] = multiply_add(coefficient_[c][i] - Float8{}, x, sum[c]);
        }
        for (size_t c = 0; c < 3; ++c) store8(sum[c], &fitted[c][o]);
    }
    return true;
}

/// Subtracts the value at the centre. False where the feature is as good as constant: one that
/// varies by less than kConstant gets next to nothing from the ridge.
bool FitWindow::centre(Cells& feature) const {
    constexpr float kConstant = 3e-4f;
    const float value = feature[kOffsets / 2];
    std::fill(feature.begin() + kOffsets, feature.end(), value);
    Float8 most{};
    for (size_t o = first_; o < end_; o += kLanes) {
        const Float8 difference = load8(&feature[o]) - value;
        const Float8 size = difference < 0.0f ? -difference : difference;
        most = most < size ? size : most;
        store8(difference, &feature[o]);
    }
    for (size_t k = 0; k < kLanes; ++k)
        if (most[k] > kConstant) return true;
    return false;
}

void FitWindow::solve_normal_equations(const Basis& basis, const Cells& weight) {
    const size_t n = basis.size;
    // Weight the functions. The first one is 1: its products with the weights are the weights
    Cells& w = weighted_[0];
    for (size_t o = first_; o < end_; o += kLanes)
        store8(load8(&weight[o]) * load8(&sampled_[o]), &w[o]);
    for (size_t i = 1; i < n; ++i) {
        const Cells& x = *basis.function[i];
        for (size_t o = first_; o < end_; o += kLanes)
            store8(load8(&w[o]) * load8(&x[o]), &weighted_[i][o]);
    }
    // Multiply the weighted functions with all columns: the functions and, after them, the colours
    std::array<const float*, kBasis + 3> column{};
    for (size_t i = 0; i < n; ++i) column[i] = basis.function[i]->data() + first_;
    for (size_t c = 0; c < 3; ++c) column[n + c] = color_[c].data() + first_;
    double a[kBasis][kBasis + 3] = {};
    for (size_t i = 0; i < n; i += 2) {
        const size_t next = std::min(i + 1, n - 1);
        const float* const rows[2] = {weighted_[i].data() + first_,
                                      weighted_[next].data() + first_};
        const auto multiply = [&]<size_t Columns>(size_t j) {
            const float* columns[Columns];
            std::copy_n(&column[j], Columns, columns);
            float sums[2][Columns];
            products<2, Columns>(rows, columns, end_ - first_, sums);
            for (size_t k = 0; k < Columns; ++k) {
                a[i][j + k] = double(sums[0][k]);
                a[next][j + k] = double(sums[1][k]);
            }
        };
        size_t j = i;
        for (; j + 4 <= n + 3; j += 4) multiply.operator()<4>(j);
        switch (n + 3 - j) {
            case 1:
                multiply.operator()<1>(j);
                break;
            case 2:
                multiply.operator()<2>(j);
                break;
            case 3:
                multiply.operator()<3>(j);
                break;
            default:
                break;
        }
    }
    total_ = float(a[0][0]);
    if (!(total_ > 0)) return;
    // Add the ridge, relative to each function's own spread, and a floor below which a feature
    // counts as constant: smaller differences are rounding and left-over noise
    constexpr double kRidge = 1e-3, kFloor = 1e-5;
    for (size_t i = 1; i < n; ++i) a[i][i] += kRidge * a[i][i] + kFloor * a[0][0];
    eliminate(n, a);
}

/// Solves the symmetric positive definite system by Gauss elimination; only its upper half is read.
void FitWindow::eliminate(size_t n, double (&a)[kBasis][kBasis + 3]) {
    for (size_t i = 0; i < n; ++i) {
        const double inverse = 1 / a[i][i];
        for (size_t r = i + 1; r < n; ++r) {
            const double factor = a[i][r] * inverse;
            for (size_t j = r; j < n + 3; ++j) a[r][j] -= factor * a[i][j];
        }
    }
    for (size_t i = n; i-- > 0;) {
        double sum[3] = {a[i][n], a[i][n + 1], a[i][n + 2]};
        for (size_t j = i + 1; j < n; ++j)
            for (size_t c = 0; c < 3; ++c) sum[c] -= a[i][j] * double(coefficient_[c][j]);
        for (size_t c = 0; c < 3; ++c) coefficient_[c][i] = float(sum[c] / a[i][i]);
    }
}

}  // namespace covtrace
