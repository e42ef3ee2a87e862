/// Reflectances that light meets several times before it leaves, as below a coat.
///
/// The colour of a spectrum's square is not the square of its colour: reflected again, a saturated
/// colour grows more saturated than its channels tell. A renderer of spectra such as pbrt-v4 has
/// that of itself; here the colours of the first powers are found from the smooth spectrum of
/// colour/sigmoid_spectrum.h. See docs/decisions/0078-colours-below-a-coat.md.
#pragma once

#include <array>
#include <vector>

#include "colour/illuminant_adaptation.h"
#include "core/vec.h"

namespace covtrace {

/// Colours of a spectrum's powers: [j] is the colour, over the light's, of the spectrum to the
/// power of j + 1. The first is the reflectance to render with. The others may have channels below
/// 0 and above 1, where they lie outside Rec.709.
using ReflectancePowers = std::array<Rgb, 5>;

/// The powers of a reflectance, brought into [0, 1], under the light that it is adapted to; those
/// of greys are exact. Fits a spectrum, some 10 microseconds: for load time.
ReflectancePowers reflectance_powers(Rgb reflectance, const IlluminantAdaptation& light = {});

/// Colour of light that is reflected up to `bounces` times and of which the share `again` comes
/// back after each: the sum of again^j S^(j + 1) over j < bounces, from 0 to that of white. Past
/// the last power that is known, each channel goes on by the ratio of the last two; at again = 0.6
/// the whole is then within 1.5 % of the largest channel.
Rgb sum_of_bounces(const ReflectancePowers& powers, float again, int bounces);

/// Interpolates reflectance_powers() in a table, for textures: no allocation, some 10 nanoseconds.
/// Immutable and thread-safe after construction.
class ReflectancePowersTable {
  public:
    /// Takes powers channel by channel, as if light had three wavelengths.
    ReflectancePowersTable() = default;
    /// Fills the table, which takes some 0.1 seconds.
    explicit ReflectancePowersTable(const IlluminantAdaptation& light);
    ReflectancePowers operator()(Rgb reflectance) const;

  private:
    /// Powers less those taken channel by channel, at the nodes of colour/colour_grid.h.
    std::vector<ReflectancePowers> changes_;
};

}  // namespace covtrace
