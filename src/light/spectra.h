/// The spectra of all lights of a scene, which the frequency analysis starts from.
#pragma once

#include <optional>
#include <vector>

#include "light/emitter_spectrum.h"
#include "light/environment_spectrum.h"
#include "light/image_spectrum.h"
#include "light/lights.h"
#include "light/source_spectrum.h"

namespace covtrace {

/// The spectra of all lights; thread-safe.
class LightSpectra {
  public:
    /// Measures all lights; they, and the geometry that they are on, must outlive this.
    explicit LightSpectra(const Lights& lights);

    /// Spectrum of the emitter of a sample that lights something, without its border: only an
    /// emitter in view shows that.
    SourceSpectrum source_spectrum(const LightSample& s, float time) const;
    /// Spectrum of the shape that was hit; empty where it does not emit. The border is left
    /// infinitely far away unless it is asked for: finding it takes a search.
    SourceSpectrum source_spectrum(const SurfaceHit& emitter, bool with_border) const;
    /// Whether the infinite lights shine alike from all directions, with a spectrum that is zero.
    bool has_even_sky() const { return environments_.size() == 1 && !environments_[0].varies(); }
    /// Spectrum of all infinite lights together around the direction `w`, weighted by radiance;
    /// with the rims of the discs that rays of the kind `seen_by` meet, where `w` is seen itself.
    SourceSpectrum environment_spectrum(Vec3 w, std::optional<RayKind> seen_by = {}) const;

  private:
    SourceSpectrum area_spectrum(size_t i, Vec3 position, Vec3 normal, float time,
                                 bool with_border) const;
    SourceSpectrum sky_spectrum(Vec3 w) const;

    const Lights::Impl* lights_;
    // One for each light of its kind, in the order of the tables of `lights_`.
    std::vector<EmitterSpectrum> emitters_;
    std::vector<std::optional<LightImageSpectrum>> images_;  ///< of point lights
    std::vector<EnvironmentSpectrum> environments_;
};

}  // namespace covtrace
