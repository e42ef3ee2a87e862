/// Scattering at one vertex: from the light that arrives at a surface to the light that leaves it.
#pragma once

#include "covariance/covariance.hpp"
#include "frequency/brdf_covariance.h"
#include "frequency/light_source.h"
#include "frequency/scatter_point.h"

namespace covtrace {

/// The light that leaves a vertex towards the camera: the sum, by luminance, over all lobes of all
/// events there. Leaving is linear and the same for all of the light, so it is done once.
class ScatterSum {
  public:
    /// Begins with no light; `point` must outlive this object.
    explicit ScatterSum(const ScatterPoint& point) : point_(point), frame_(point.leaving) {}

    /// Sends `arriving` (its frame's z is the direction of travel towards the surface) through the
    /// lobes of an event and adds the result, `weight` in all. `emitter` is the place where the
    /// light was last sent out. Lobes with less than `least` of the event's light are left out,
    /// except the brightest. `lobes` must outlive this object.
    void add(const LightField& arriving, const covariance::Emitter<double>& emitter,
             const LobeShares& lobes, double weight, BrdfCovariance rule, double least = 0);

    double weight() const { return weight_; }
    /// The sum, which travels along point.leaving.z, in whatever frame. Only where the weight is
    /// above 0, and once.
    LightField leaving();

  private:
    LightField enter(const LightField& arriving) const;
    /// Adds light through one lobe. `even`: the light has no variation; it need not have entered
    /// then.
    void add_through(const LightField& entered, bool even,
                     const covariance::Emitter<double>& emitter, const LobeShare& lobe,
                     double weight, BrdfCovariance rule);
    void add_diffuse(const LightField& entered, bool even,
                     const covariance::Emitter<double>& emitter, const LobeShare& lobe,
                     double weight, BrdfCovariance rule);
    /// Adds light that a sheen reflects: as a diffuse surface does, by a window of its own on the
    /// arriving and on the leaving light.
    void add_sheen(const LightField& entered, bool even, const LobeShare& lobe, double weight,
                   BrdfCovariance rule);
    void add(const LightField& left, double weight);
    /// Adds the window of the light that the coat over diffuse lobes lets out.
    void add_let_out();
    void add_slopes(const covariance::Sym2<double>& window, const covariance::Frame<double>& frame);
    /// Whether slopes along this frame are added as they are: the first frame decides.
    bool takes_slopes_of(const covariance::Frame<double>& frame);
    covariance::Mat2<double> to_own(const covariance::Frame<double>& frame) const;

    const ScatterPoint& point_;
    /// Weighted sum of the leaving light, between surface_enter and surface_exit, with slopes along
    /// `frame_`; without the spectra that all light of a diffuse lobe has in common.
    covariance::SymmetricMatrix5<double> sum_;
    covariance::Frame<double> frame_;
    bool has_slopes_ = false;
    double weight_ = 0;
    /// Weights of diffuse lobes, whose light all has the spectrum of their texture.
    double reflected_ = 0, transmitted_ = 0;
    const LobeShare* coat_ = nullptr;  ///< coat over lobes of the weight `coated_`
    double coated_ = 0;
};

}  // namespace covtrace
