/// Reflectances for rendering, in RGB, of surfaces under coloured light.
///
/// The product of two colours is not the colour of the product of their spectra. Under white light
/// little is lost; under strongly coloured light the error grows with every bounce. Spectral
/// prefiltering (Ward and Eydelberg-Vileshin, "Picture perfect RGB rendering using spectral
/// prefiltering and sharp color primaries", Eurographics Workshop on Rendering 2002) replaces each
/// reflectance by the one that is exact at the first bounce of the dominant light:
///
///     colour(S_reflectance S_light) / colour(S_light)
///
/// with the smooth spectra of colour/sigmoid_spectrum.h. See
/// docs/decisions/0001-reflectance-under-coloured-light.md.
#pragma once

#include <span>
#include <vector>

#include "colour/spectrum.h"
#include "core/vec.h"

namespace covtrace {

/// Adapts reflectances to one dominant light. Immutable and thread-safe after construction.
class IlluminantAdaptation {
  public:
    /// Adapts to white light, which changes nothing.
    IlluminantAdaptation() = default;
    /// Adapts to the light `illuminant`: its linear Rec.709 colour, of any brightness. Black, grey
    /// and non-finite ones count as white. Channels below 1/20 of the largest count as that much:
    /// the factor for a fainter channel is ill-defined and hardly seen.
    explicit IlluminantAdaptation(Rgb illuminant);

    bool is_identity() const { return observer_.empty(); }
    /// Samples as of observer_samples(), but under the light: what a factor at a wavelength adds to
    /// the colour over the light's own.
    std::span<const ObserverSample> observer() const {
        return is_identity() ? observer_samples() : observer_;
    }
    /// The reflectance (or transmittance) to render with, in [0, 1]; greys stay as they are. Fits a
    /// spectrum, some 10 microseconds: for load time.
    Rgb operator()(Rgb reflectance) const;
    /// The change that adaptation adds to a reflectance in [0, 1], before the sum is cut to [0, 1].
    Rgb change(Rgb reflectance) const;

  private:
    std::vector<ObserverSample> observer_;
};

/// Adaptation by interpolation in a table, for textures: no allocation, some 10 nanoseconds. Within
/// 0.005 of IlluminantAdaptation for lights no more colourful than a candle; within 0.025 for
/// saturated reflectances under the most saturated light. Greys stay as they are here too.
/// Immutable and thread-safe after construction.
class AdaptationTable {
  public:
    /// Makes the identity.
    AdaptationTable() = default;
    explicit AdaptationTable(const IlluminantAdaptation& adaptation);
    Rgb operator()(Rgb reflectance) const;

  private:
    std::vector<Rgb> changes_;  ///< at the nodes of colour/colour_grid.h; empty for the identity
};

}  // namespace covtrace
