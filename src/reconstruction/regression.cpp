#include "reconstruction/regression.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/parallel.h"
#include "reconstruction/patch_distance.h"
#include "reconstruction/regression_window.h"

namespace covtrace {

namespace {

constexpr int kReach = FitWindow::kReach, kSide = FitWindow::kSide;
constexpr int kStride = 3;  // pixels from centre to centre
using Patches = PatchDistance<1, kStride, 48>;
constexpr int kBlock = Patches::kBlock;
constexpr size_t kCells = FitWindow::kCells, kCentresPerSide = Patches::kPatches;

using Cells = FitWindow::Cells;

/// The sums that one block of centres adds to the pixels it reaches: weighted colours and weights.
/// The first of its pixels is kReach to the left of the block and above it.
struct Contribution {
    void clear(int columns, int rows) {
        stride = size_t(columns) + 2 * kReach;
        const size_t size = stride * (size_t(rows) + 2 * kReach) + kLanes;
        for (std::vector<float>& sum : sums) sum.assign(size, 0.0f);
    }
    size_t stride = 0;
    std::array<std::vector<float>, 4> sums;
};

/// The patches of the half that guides, by their colours and by their light.
struct PatchDistances {
    explicit PatchDistances(const HalfBuffer& guide)
        : color(guide.color, guide.color_variance, kReach) {
        const float noise = relative_noise(guide);
        if (noise < kTellingNoise) light = light_of(guide, noise);
    }
    Patches color;
    std::optional<Patches> light;  ///< there where it tells more than the colours do

  private:
    /// Median of the colours' noise over their brightness.
    static float relative_noise(const HalfBuffer& guide) {
        std::vector<float> noise(guide.count.size());
        for (size_t i = 0; i < noise.size(); ++i) {
            float variance = 0, sum = 0;
            for (size_t c = 0; c < 3; ++c) {
                variance += guide.color_variance[c][i];
                sum += guide.color[c][i];
            }
            noise[i] = std::sqrt(3 * variance) / (std::max(0.0f, sum) + 3 * kDark);
        }
        const auto middle = noise.begin() + std::ptrdiff_t(noise.size() / 2);
        std::nth_element(noise.begin(), middle, noise.end());
        return *middle;
    }

    static Patches light_of(const HalfBuffer& guide, float noise) {
        // The quotient is limited by the noise: pixels that reflect less than it show other light,
        // as highlights or objects behind them.
        const float least = std::max(kLeastAlbedo, noise);
        ColorPlanes light = guide.color, variance = guide.color_variance;
        for (size_t c = 0; c < 3; ++c)
            for (size_t i = 0; i < light[c].size(); ++i) {
                const float scale = 1 / (std::max(0.0f, guide.feature[c][i]) + least);
                light[c][i] *= scale;
                variance[c][i] *= scale * scale;
            }
        return {light, variance, kReach};
    }

    /// Constants that keep quotients finite where there is no light and where nothing reflects.
    /// kDark is in the range of sqrt(kDarkSquared), below which errors are no longer relative,
    /// either.
    static constexpr float kDark = 0.05f, kLeastAlbedo = 0.01f;
    /// Noise up to which patches of light are compared: with more, textures are hardly told apart,
    /// and these patches gain less than their time is worth (docs/decisions/0094).
    static constexpr float kTellingNoise = 0.1f;
};

/// Fits of all centres in one block, for every window.
class Block {
  public:
    Block(const RegressionInputs& in, const PatchDistances& distance,
          std::span<const RegressionWindow> windows)
        : in_(in), distance_(distance), windows_(windows) {}

    void run(int x0, int y0, std::span<Contribution> out) {
        // Compare the patches, by colours and, where it tells more, by light
        const int columns = distance_.color.columns(x0), rows = distance_.color.rows(y0);
        for (Contribution& c : out) c.clear(columns, rows);
        collect_distances(distance_.color, x0, y0, distances_[size_t(PatchesOf::colors)]);
        std::vector<float>& either = distances_[size_t(PatchesOf::colors_or_light)];
        const std::vector<float>& color = distances_[size_t(PatchesOf::colors)];
        if (distance_.light) {
            collect_distances(*distance_.light, x0, y0, either);
            for (size_t i = 0; i < either.size(); ++i) either[i] = std::min(either[i], color[i]);
        }
        // Fit around every centre, once for each window
        for (int y = 0; y < rows; y += kStride)
            for (int x = 0; x < columns; x += kStride) {
                window_.move_to(in_, x0 + x, y0 + y);
                const size_t first =
                    (size_t(y / kStride) * kCentresPerSide + size_t(x / kStride)) * kCells;
                for (size_t k = 0; k < windows_.size(); ++k) {
                    const PatchesOf patches =
                        distance_.light ? windows_[k].patches : PatchesOf::colors;
                    const float* d = &distances_[size_t(patches)][first];
                    window_.set_weights(windows_[k], d, x0 + x, y0 + y, weight_);
                    if (window_.fit(windows_[k].noise, weight_, fitted_)) add(x, y, out[k]);
                }
            }
    }

  private:
    static void collect_distances(const Patches& distance, int x0, int y0,
                                  std::vector<float>& distances) {
        const size_t centres_down = size_t(distance.rows(y0) + kStride - 1) / kStride;
        distances.resize(centres_down * kCentresPerSide * kCells);
        float* out = distances.data();
        for (int dy = -kReach; dy <= kReach; ++dy)
            for (int dx = -kReach; dx <= kReach; ++dx, ++out)
                if (distance.reaches(x0, y0, dx, dy))  // else there is no weight either
                    distance.block(x0, y0, dx, dy, out, kCells);
    }

    void add(int x, int y, Contribution& out) const {
        constexpr size_t kWhole = kSide / kLanes * kLanes;
        for (int row = window_.first_row(); row < window_.end_row(); ++row) {
            const size_t to = size_t(y + row) * out.stride + size_t(x), from = size_t(row) * kSide;
            for (size_t k = 0; k < kSide; k += kLanes) {
                Float8 w = load8(&weight_[from + k]);
                if (k == kWhole)  // the next row of the window follows
                    for (size_t lane = kSide - kWhole; lane < kLanes; ++lane) w[lane] = 0;
                const auto add_to = [&](std::vector<float>& sums, const Float8& value) {
                    store8(multiply_add(w, value, load8(&sums[to + k])), &sums[to + k]);
                };
                for (size_t c = 0; c < 3; ++c) add_to(out.sums[c], load8(&fitted_[c][from + k]));
                add_to(out.sums[3], 1 - Float8{});
            }
        }
    }

    const RegressionInputs& in_;
    const PatchDistances& distance_;
    std::span<const RegressionWindow> windows_;
    FitWindow window_;
    Cells weight_{};
    std::array<Cells, 3> fitted_{};
    // One list by PatchesOf; distances centre by centre.
    std::array<std::vector<float>, 2> distances_;
};

}  // namespace

std::vector<ColorPlanes> regress(const HalfBuffer& half, const HalfBuffer& guide,
                                 const FeaturePlanes& filtered,
                                 std::span<const RegressionWindow> windows) {
    const int w = half.count.width, h = half.count.height;
    const RegressionInputs in(half, filtered);
    const PatchDistances distance(guide);

    const int blocks_x = (w + kBlock - 1) / kBlock, blocks_y = (h + kBlock - 1) / kBlock;
    // A pixel is reached by its own row of blocks and by those above and below, and by no others.
    static_assert(kReach < kBlock);
    std::vector<std::vector<Contribution>> contributions(size_t(blocks_x) * size_t(blocks_y));
    const auto fit_rows = [&](int begin, int end) {
        const int64_t first = int64_t(begin) * blocks_x;
        parallel_for(int64_t(end) * blocks_x - first, [&](int64_t i) {
            const int64_t b = first + i;
            auto& part = contributions[size_t(b)];
            part.resize(windows.size());
            Block(in, distance, windows)
                .run(int(b % blocks_x) * kBlock, int(b / blocks_x) * kBlock, part);
        });
    };

    std::vector<ColorPlanes> result(windows.size());
    for (ColorPlanes& planes : result) planes.fill(Plane(w, h));
    const auto add_up = [&](int y) {
        for (size_t k = 0; k < windows.size(); ++k)
            for (int x = 0; x < w; ++x) {
                // Add up the blocks that reach this pixel, in a fixed order
                std::array<float, 4> sum{};
                for (int by = std::max(0, (y - kReach) / kBlock);
                     by <= std::min(blocks_y - 1, (y + kReach) / kBlock); ++by)
                    for (int bx = std::max(0, (x - kReach) / kBlock);
                         bx <= std::min(blocks_x - 1, (x + kReach) / kBlock); ++bx) {
                        const Contribution& part =
                            contributions[size_t(by) * size_t(blocks_x) + size_t(bx)][k];
                        const size_t at = size_t(y - by * kBlock + kReach) * part.stride +
                                          size_t(x - bx * kBlock + kReach);
                        for (size_t c = 0; c < 4; ++c) sum[c] += part.sums[c][at];
                    }
                for (size_t c = 0; c < 3; ++c)
                    result[k][c](x, y) = sum[3] > 0 ? sum[c] / sum[3] : half.color[c](x, y);
            }
    };
    // Fit and add up a few rows of blocks at a time: all contributions together are several times
    // the image
    constexpr int kRowsAtOnce = 4;
    for (int row = 0, fitted = 0; row < blocks_y; row += kRowsAtOnce) {
        const int end = std::min(row + kRowsAtOnce, blocks_y), needed = std::min(end + 1, blocks_y);
        fit_rows(fitted, needed);
        fitted = needed;
        const int first_y = row * kBlock, end_y = std::min(end * kBlock, h);
        parallel_for_rows(w, end_y - first_y, [&](int y) { add_up(first_y + y); });
        for (int done = std::max(0, row - 1); done < end - 1; ++done)
            for (int bx = 0; bx < blocks_x; ++bx)
                contributions[size_t(done) * size_t(blocks_x) + size_t(bx)] = {};
    }
    return result;
}

}  // namespace covtrace
