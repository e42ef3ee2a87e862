#include "foreign/phased_denoiser.h"

#include <algorithm>
#include <array>
#include <utility>

namespace covtrace {

namespace {

constexpr int kStep = 2;

/// The pixels of every kStep-th row and column from (x0, y0) on.
Plane phase_of(const Plane& plane, int x0, int y0) {
    Plane phase((plane.width - x0 + kStep - 1) / kStep, (plane.height - y0 + kStep - 1) / kStep);
    for (int y = 0; y < phase.height; ++y)
        for (int x = 0; x < phase.width; ++x) phase(x, y) = plane(x0 + kStep * x, y0 + kStep * y);
    return phase;
}

std::array<Plane, 3> phase_of(const std::array<Plane, 3>& planes, int x0, int y0) {
    return {phase_of(planes[0], x0, y0), phase_of(planes[1], x0, y0), phase_of(planes[2], x0, y0)};
}

void put_back(const Plane& phase, int x0, int y0, Plane& plane) {
    for (int y = 0; y < phase.height; ++y)
        for (int x = 0; x < phase.width; ++x) plane(x0 + kStep * x, y0 + kStep * y) = phase(x, y);
}

}  // namespace

size_t PhasedDenoiser::memory(size_t pixels) const {
    return whole_.memory(pixels / (kStep * kStep) + 1);
}

std::vector<ColorPlanes> PhasedDenoiser::denoise(const NoisyFeatures& features,
                                                 std::vector<NoisyImage> images) const {
    std::vector<ColorPlanes> results;
    for (const NoisyImage& image : images) results.push_back(image.color);
    for (int y0 = 0; y0 < std::min(kStep, images[0].color[0].height); ++y0)
        for (int x0 = 0; x0 < std::min(kStep, images[0].color[0].width); ++x0) {
            NoisyFeatures some = features;
            some.albedo = phase_of(features.albedo, x0, y0);
            some.normal = phase_of(features.normal, x0, y0);
            std::vector<NoisyImage> phases;
            for (const NoisyImage& image : images) {
                phases.push_back(image);
                phases.back().color = phase_of(image.color, x0, y0);
            }
            const std::vector<ColorPlanes> clean = whole_.denoise(some, std::move(phases));
            for (size_t k = 0; k < clean.size(); ++k)
                for (size_t c = 0; c < 3; ++c) put_back(clean[k][c], x0, y0, results[k][c]);
        }
    return results;
}

}  // namespace covtrace
