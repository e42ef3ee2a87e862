/// The colour of light that meets a medium and what is below it again and again, under a coat.
///
/// The colour of a spectrum's power is not the power of its colour: what an orange medium scatters
/// ten times is a third less red than its channels tell. Where both the medium's albedo and the
/// base's reflectance are known beforehand, light keeps a share of its spectrum in bands; else it
/// takes channels. See docs/decisions/0160-bands-in-the-gap.md.
#pragma once

#include "bsdf/bsdf.h"
#include "colour/colour_bands.h"

namespace covtrace {

/// The spectra of a gap's medium and of a diffuse base.
struct GapSpectrum {
    ColourBands bands;
    BandValues albedo{};
    BandValues base{};      ///< where has_base
    bool has_base = false;  ///< whether the base's reflectance is here; else it goes by channels
};

/// Colour of a walk's light by what the medium, and a base of GapSpectrum, have kept of it.
class GapColour {
  public:
    explicit GapColour(const GapScattering& gap) : gap_(gap) { shares_.fill(1); }
    void scatter() {
        if (gap_.spectrum)
            keep(gap_.spectrum->albedo);
        else
            value_ *= gap_.albedo;
    }
    void meet_base() {
        if (gap_.spectrum && gap_.spectrum->has_base) keep(gap_.spectrum->base);
    }
    Rgb value() const { return value_; }

  private:
    void keep(const BandValues& values) {
        for (size_t b = 0; b < values.size(); ++b) shares_[b] *= values[b];
        value_ = gap_.spectrum->bands.colour(shares_);
    }
    const GapScattering& gap_;
    BandValues shares_;
    Rgb value_{1};
};

}  // namespace covtrace
