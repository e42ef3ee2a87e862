/// Panels of spectra: amplitudes in grey, with predicted covariances as ellipses over them.
#pragma once

#include "reproduce/grid_spectrum.h"
#include "reproduce/panels.h"

namespace covtrace::reproduce {

/// A frequency in two axes, in the units of its panel.
using Frequency = std::array<double, 2>;

/// A panel of a sheet that shows frequencies from -range to range, 0 in the middle, x right and y
/// down.
class SpectrumPanel {
  public:
    SpectrumPanel(Sheet& sheet, int column, int row, Frequency range)
        : sheet_(sheet), column_(column), row_(row), range_(range) {}

    /// Adds the amplitudes, black at a hundredth of `most` and below, white at `most`. `units`:
    /// cells per unit of the panel's axes, such as slots per shutter interval.
    void amplitudes(const std::string& title, const GridSpectrum& spectrum, Frequency units,
                    double most);
    /// Adds where exp(-½ f' S^-1 f) around a frequency has fallen to two deviations, S in the
    /// panel's units squared; only where that is within the panel as a whole.
    void ellipse(Frequency middle, const covariance::Sym2<double>& s, Ink ink);
    /// Adds the rectangle from -half to half.
    void box(Frequency half, Ink ink);

  private:
    Vec2 at(Frequency f) const;

    Sheet& sheet_;
    int column_, row_;
    Frequency range_;
};

/// The largest amplitude of a spectrum.
double largest_amplitude(const GridSpectrum& spectrum);

}  // namespace covtrace::reproduce
