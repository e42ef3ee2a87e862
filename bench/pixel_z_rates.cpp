// How often the per-pixel z-test of tests/statistical alarms on renders that are right, by scene
// and level.
//
//   pixel_z_rates [SPP [REFERENCES [SEEDS]]]      128, 1000 and 1000 by default
#include <cstdlib>

#include <fmt/format.h>

#include "tests/statistical/pixel_z.h"

int main(int count, char** arguments) {
    using namespace covtrace;
    const auto number = [&](int i, int otherwise) {
        return count > i ? std::atoi(arguments[i]) : otherwise;
    };
    const auto spp = static_cast<uint32_t>(number(1, 128));
    const auto references = static_cast<size_t>(number(2, 1000)),
               seeds = static_cast<size_t>(number(3, 1000));
    fmt::print(
        "| scene | pixels not tested | alarms at 0.01 | at 0.05 | at 0.2 |\n"
        "| --- | --- | --- | --- | --- |\n");
    for (const PixelScene& s : kScenes) {
        const RenderScene scene(
            read_pbrt_string(scene_text(s.view, std::string(s.world) + kFloor, 4), s.name, "."));
        const Reference reference(render_seeds(scene, 1000000, references, spp));
        int skipped = 0;
        for (size_t i = 0; i < kPixels; ++i)
            skipped += !reference.is_testable(i) && !reference.is_constant(i);
        std::array<double, 3> rates{};
        for (const Pixels& image : render_seeds(scene, 1, seeds, spp)) {
            const double p = image_p(image, 1, reference);
            for (size_t k = 0; k < 3; ++k)
                rates[k] += (p < std::array{0.01, 0.05, 0.2}[k]) / double(seeds);
        }
        fmt::print("| {} | {} | {:.3f} | {:.3f} | {:.3f} |\n", s.name, skipped, rates[0], rates[1],
                   rates[2]);
    }
}
