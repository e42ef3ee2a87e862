// The rate of false alarms of the per-pixel z-test of tests/statistical, by scene and level, beside
// the numbers of alarms that a right test exceeds in either direction with probability 0.01 in all
// (Šidák over scenes and levels); and the largest skewness and the mean excess kurtosis of the
// pixels' means, which are 0 where these are normal.
//
//   pixel_z_rates [SPP [REFERENCES [SEEDS [FIRST [SCENE]]]]]      256, 1000, 1000, 1, all by
//   default
//
// The references have the seeds from 1000000 on, the renders that are tested those from FIRST on.
#include <cstdlib>

#include <fmt/format.h>

#include "tests/statistical/pixel_z.h"

namespace {

using namespace covtrace;

/// The mean excess kurtosis of the pixels that are judged.
double mean_kurtosis(const std::vector<Pixels>& images, const Reference& reference) {
    double sum = 0;
    int count = 0;
    for (size_t i = 0; i < kPixels; ++i) {
        if (!reference.is_testable(i)) continue;
        double fourth = 0;
        for (const Pixels& image : images)
            fourth += std::pow(image[i] - reference.mean[i], 4) / reference.renders;
        sum += fourth / (reference.variance[i] * reference.variance[i]) - 3;
        ++count;
    }
    return sum / count;
}

}  // namespace

int main(int count, char** arguments) {
    const auto number = [&](int i, int otherwise) {
        return count > i ? std::atoi(arguments[i]) : otherwise;
    };
    const auto spp = static_cast<uint32_t>(number(1, 256));
    const int references = number(2, 1000), seeds = number(3, 1000), first = number(4, 1);
    constexpr std::array<double, 3> kAlphas{0.01, 0.05, 0.2};
    constexpr double kOutside = 0.01;
    fmt::print("| scene | pixels not tested | skewness | kurtosis |");
    for (const double alpha : kAlphas) {
        const auto [lo, hi] =
            binomial_bounds(seeds, alpha, sidak(kOutside, std::size(kScenes) * kAlphas.size()));
        fmt::print(" at {}: {} to {} |", alpha, lo, hi);
    }
    fmt::print("\n| --- | --- | --- | --- | --- | --- | --- |\n");
    for (const PixelScene& s : kScenes) {
        if (count > 5 && std::string(s.name) != arguments[5]) continue;
        const RenderScene scene(
            read_pbrt_string(scene_text(s.view, std::string(s.world) + kFloor, 4), s.name, "."));
        const std::vector<Pixels> known = render_seeds(scene, 1000000, size_t(references), spp);
        const Reference reference(known);
        int skipped = 0;
        double skewness = 0;
        for (size_t i = 0; i < kPixels; ++i) {
            skipped += !reference.is_testable(i) && !reference.is_constant(i);
            if (reference.is_testable(i))
                skewness = std::max(skewness, std::abs(reference.skewness[i]));
        }
        std::array<int, kAlphas.size()> alarms{};
        for (const Pixels& image : render_seeds(scene, uint64_t(first), size_t(seeds), spp)) {
            const double p = image_p(image, 1, reference);
            for (size_t k = 0; k < kAlphas.size(); ++k) alarms[k] += p < kAlphas[k];
        }
        fmt::print("| {} | {} | {:.2f} | {:.2f} |", s.name, skipped, skewness,
                   mean_kurtosis(known, reference));
        for (const int n : alarms) fmt::print(" {} |", n);
        fmt::print("\n");
        std::fflush(stdout);
    }
}
