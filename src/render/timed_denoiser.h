/// What a denoiser takes of a render's time.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "reconstruction/denoiser.h"
#include "render/job.h"

namespace covtrace {

/// Another denoiser, whose seconds are added up. All of its arguments must outlive it.
class TimedDenoiser : public Denoiser {
  public:
    TimedDenoiser(const Denoiser& denoiser, const Monitor& monitor, double& seconds)
        : denoiser_(denoiser), monitor_(monitor), seconds_(seconds) {}
    std::string name() const override { return denoiser_.name(); }
    size_t memory(size_t pixels) const override { return denoiser_.memory(pixels); }
    std::vector<ColorPlanes> denoise(std::vector<NoisyImage> images) const override {
        const PhaseTimer timer(monitor_, seconds_);
        return denoiser_.denoise(std::move(images));
    }

  private:
    const Denoiser& denoiser_;
    const Monitor& monitor_;
    double& seconds_;
};

}  // namespace covtrace
