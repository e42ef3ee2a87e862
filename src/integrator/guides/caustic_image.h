/// The image of a light in glossy surfaces, as the places of a small region see it.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/vec.h"
#include "integrator/guides/caustic_photons.h"

namespace covtrace {

/// Where the light of one lamp comes from that took one way over glossy surfaces.
///
/// In a flat mirror its rays seem to come from one point, the mirrored light. Over a curved surface
/// the point moves with the place that looks (a glass ball has a bright line and a cone of rays, no
/// focus), and the directions are described to first order: those to the point that suits best,
/// and what a linear function of the place adds to them.
class CausticImage {
  public:
    /// Fewest photons that a fit may be trusted with.
    static constexpr size_t kFewestPhotons = 12;

    /// Makes an image that guides nobody.
    CausticImage() = default;
    /// Fits an image to photons that came the same way, at least kFewestPhotons.
    explicit CausticImage(std::span<const CausticPhoton> photons);

    /// Fits one image or several to photons that came the same way, at least kFewestPhotons: over
    /// curved surfaces a place may see the lamp several times in one surface.
    static std::vector<CausticImage> seen_by(std::span<const CausticPhoton> photons);

    /// Unit direction to the image from a place.
    Vec3 direction(Vec3 place) const;
    /// Von Mises-Fisher concentration of the light's rays about `direction`; 0: too wide to guide.
    float kappa() const { return kappa_; }

    /// Squared distance between a photon's direction and the image's, as unit vectors.
    float miss(const CausticPhoton& photon) const;

  private:
    /// The median of `miss`: photons in the long tails of a rough mirror do not change it.
    float median_miss(std::span<const CausticPhoton> photons) const;
    /// Sets the point to the one that suits best.
    void place_point(std::span<const CausticPhoton> photons);
    /// Sets the linear function to what the directions to the point leave.
    void bend(std::span<const CausticPhoton> photons);

    Vec3 point_;
    Vec3 centre_, offset_;          ///< where the linear function has which value
    std::array<Vec3, 3> gradient_;  ///< of each component, per scene unit
    float kappa_ = 0;
};

}  // namespace covtrace
