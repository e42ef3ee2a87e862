/// The window of one regression: pixels around a centre, their weights, and the fit.
#pragma once

#include <array>

#include "core/simd.h"
#include "reconstruction/filter_field.h"
#include "reconstruction/patch_distance.h"
#include "reconstruction/regression.h"

namespace covtrace {

/// Planes that windows are cut from, with borders as wide as windows reach. `half` must outlive
/// them.
struct RegressionInputs {
    RegressionInputs(const HalfBuffer& half, const FeaturePlanes& features);
    std::array<PaddedPlane, kFeatures> filtered;
    const FeaturePlanes& noisy;  ///< without borders: a copy would cost 32 bytes per pixel
    std::array<PaddedPlane, 3> color;
    PaddedPlane inside;   ///< 1 in the image, 0 outside
    PaddedPlane sampled;  ///< 1 where a pixel has samples, 0 elsewhere and outside
};

class FitWindow {
  public:
    static constexpr int kReach = kRegressionReach, kSide = 2 * kReach + 1;
    static constexpr size_t kOffsets = size_t(kSide) * kSide;
    static constexpr size_t kCells = (kOffsets + kLanes - 1) / kLanes * kLanes;
    /// One number per pixel of the window, row by row; the padding is 0. Cells are aligned, or
    /// every second vector of them would lie across two lines of the cache.
    struct alignas(sizeof(Float8)) Cells : std::array<float, kCells> {};

    FitWindow();
    FitWindow(const FitWindow&) = delete;
    FitWindow& operator=(const FitWindow&) = delete;

    /// Moves the window to the centre (x, y).
    void move_to(const RegressionInputs& in, int x, int y);

    /// Sets the weights of all pixels. `distance`: kCells distances of their patches from the
    /// centre's.
    void set_weights(const RegressionWindow& window, const float* distance, int x, int y,
                     Cells& weight) const;

    /// Fits the colours with these features and weights and writes the fit's value at every pixel.
    /// Returns false where there is nothing to fit.
    bool fit(FeatureNoise noise, const Cells& weight, std::array<Cells, 3>& fitted);

    /// Rows of the window that are in the image. The fit's values are not set in others, where
    /// weights would be 0.
    int first_row() const { return first_row_; }
    int end_row() const { return end_row_; }

  private:
    static constexpr size_t kPositions = 3;                   // 1, x, y
    static constexpr size_t kBasis = kPositions + kFeatures;  // and the features

    /// Functions that the colours are explained by: 1, x, y and features.
    struct Basis {
        std::array<Cells, kFeatures> feature{};  // those that vary come first
        std::array<const Cells*, kBasis> function{};
        size_t size = kPositions;
    };

    bool centre(Cells& feature) const;
    void solve_normal_equations(const Basis& basis, const Cells& weight);
    void eliminate(size_t n, double (&a)[kBasis][kBasis + 3]);

    int first_row_ = 0, end_row_ = kSide;
    size_t first_ = 0, end_ = kCells;  // cells, in whole vectors, that hold the rows in the image
    Cells one_{}, x_{}, y_{};          // positions relative to the centre, in units of the reach
    std::array<Basis, 2> basis_{};     // bases by FeatureNoise
    std::array<Cells, 3> color_{};
    Cells inside_{}, sampled_{};
    std::array<Cells, kBasis> weighted_{};
    float total_ = 0;
    float coefficient_[3][kBasis] = {};
};

}  // namespace covtrace
