/// Spectra of real grids of values, such as pixels: the discrete Fourier transform, in cycles per
/// cell.
#pragma once

#include <array>
#include <complex>
#include <vector>

namespace covtrace::reproduce {

/// Real values row by row.
struct Grid {
    Grid(int w, int h) : width(w), height(h), values(size_t(w) * size_t(h), 0) {}
    int width, height;
    std::vector<double> values;

    double& at(int x, int y) { return values[size_t(y) * size_t(width) + size_t(x)]; }
    double at(int x, int y) const { return values[size_t(y) * size_t(width) + size_t(x)]; }
};

/// The discrete Fourier transform of a grid, frequency 0 in column width/2 and row height/2.
class GridSpectrum {
  public:
    explicit GridSpectrum(const Grid& grid);
    int width() const { return width_; }
    int height() const { return height_; }
    std::complex<double> at(int i, int j) const {
        return values_[size_t(j) * size_t(width_) + size_t(i)];
    }
    /// Frequency of column i, cycles per cell, in [-1/2, 1/2).
    double frequency_x(int i) const { return double(i - width_ / 2) / width_; }
    /// Frequency of row j, cycles per cell.
    double frequency_y(int j) const { return double(j - height_ / 2) / height_; }

  private:
    int width_, height_;
    std::vector<std::complex<double>> values_;
};

/// The grid times a Gaussian around its middle with these deviations, in cells.
Grid windowed(const Grid& grid, std::array<double, 2> deviations);

/// The variance that such a window adds to the amplitudes of a Gaussian spectrum along an axis,
/// (cycles per cell)²: 1/(4 pi² deviation²).
double window_variance(double deviation);

/// A copy of the grid in the middle of a larger one of zeros, whose spectrum has finer bins.
Grid padded(const Grid& grid, int width, int height);

}  // namespace covtrace::reproduce
