/// A denoiser for images whose neighbouring pixels share noise.
#pragma once

#include "reconstruction/denoiser.h"

namespace covtrace {

/// Denoises the pixels of every second row and column by themselves, four pictures of half the
/// width and height, and puts them together again. Networks are trained on pixels with noise of
/// their own; where a renderer splats a sample into several pixels they take its noise for detail
/// and leave blotches. Pixels two apart share hardly any sample (Zhou et al., "When AWGN-Based
/// Denoiser Meets Real Noises", 2020, who do so for cameras' noise).
class PhasedDenoiser : public Denoiser {
  public:
    explicit PhasedDenoiser(const Denoiser& whole) : whole_(whole) {}
    std::string name() const override { return whole_.name(); }
    size_t memory(size_t pixels) const override;
    std::vector<ColorPlanes> denoise(const NoisyFeatures& features,
                                     std::vector<NoisyImage> images) const override;

  private:
    const Denoiser& whole_;
};

}  // namespace covtrace
