/// Timing of a denoiser within a render.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "reconstruction/denoiser.h"
#include "render/job.h"

namespace covtrace {

/// Wrapper around a denoiser that adds its seconds up, and takes them from those of the phase
/// around it. All of the constructor's arguments must outlive it.
class TimedDenoiser : public Denoiser {
  public:
    TimedDenoiser(const Denoiser& denoiser, const Monitor& monitor, double& seconds, double& around)
        : denoiser_(denoiser), monitor_(monitor), seconds_(seconds), around_(around) {}
    std::string name() const override { return denoiser_.name(); }
    size_t memory(size_t pixels) const override { return denoiser_.memory(pixels); }
    std::vector<ColorPlanes> denoise(const NoisyFeatures& features,
                                     std::vector<NoisyImage> images) const override {
        const double start = monitor_.elapsed();
        std::vector<ColorPlanes> results = denoiser_.denoise(features, std::move(images));
        const double taken = monitor_.elapsed() - start;
        seconds_ += taken;
        around_ -= taken;
        return results;
    }

  private:
    const Denoiser& denoiser_;
    const Monitor& monitor_;
    double &seconds_, &around_;
};

}  // namespace covtrace
