// Compares reconstructions of the same samples, without rendering again for each:
//
//     reconstruction_sweep SPP WIDTHxHEIGHT SCENE.pbrt REFERENCE.exr [SCENE REFERENCE ...]
//
// Traces every scene with `--method hybrid` at SPP (seed 1) and prints for every set of candidates
// and selector the trimmed relMSE per scene and the geometric mean of raw error over error. The
// reference's own noise is in all of these numbers alike. docs/reconstruction.md has the table.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "image/compare.h"
#include "reconstruction/hybrid.h"
#include "render/hybrid.h"
#include "scene/read_scene.h"

using namespace covtrace;

namespace {

struct Case {
    Halves halves;
    std::vector<Covariance2> spectrum;
    Image reference;
    double raw = 0;
};

double error(const ColorPlanes& color, const Image& reference) {
    Image image;
    image.data = reference.data;
    image.display = reference.display;
    for (size_t c = 0; c < 3; ++c)
        image.add_channel(std::string(1, "RGB"[c])).values = color[c].values;
    return compare(image, reference).relmse_trimmed;
}

Case load(double spp, const std::array<int, 2>& size, const char* scene_file,
          const char* reference) {
    SceneDescription description = read_pbrt(scene_file);
    SceneOverrides overrides;
    overrides.resolution = size;
    apply(overrides, description);
    RenderScene scene(std::move(description));
    RenderOptions options;
    options.spp = spp;
    options.seed = 1;
    Monitor monitor;
    RenderJob job(scene, options, monitor);
    const HybridSamples samples = trace_hybrid(job);
    Case c{halves_of(samples.film), samples.prediction.spectrum, read_image(reference)};
    ColorPlanes raw = c.halves[0].color;
    for (size_t k = 0; k < 3; ++k)
        for (size_t i = 0; i < raw[k].size(); ++i)
            raw[k][i] = 0.5f * (raw[k][i] + c.halves[1].color[k][i]);
    c.raw = error(raw, c.reference);
    return c;
}

std::vector<std::pair<std::string, HybridSettings>> variants() {
    const HybridSettings chosen;
    std::vector<std::pair<std::string, HybridSettings>> list{{"as delivered", chosen}};
    const auto add = [&](const std::string& name, const auto& change) {
        list.emplace_back(name, chosen);
        change(list.back().second);
    };
    add("best single candidate", [](auto& s) { s.mix = false; });
    for (float sigma : {1.5f, 5.0f})
        add(fmt::format("judged over sigma {}", sigma), [&](auto& s) { s.sigma = sigma; });
    add("without the Gaussians", [](auto& s) { s.gaussians.clear(); });
    add("without shaped windows", [](auto& s) { s.fits.back().shaped = false; });
    add("Gaussians alone", [](auto& s) { s.fits.clear(); });
    add("plain windows, mixed", [](auto& s) {
        s.gaussians.clear();
        s.fits = {{0.5f, false}, {1, false}};
    });
    add("plain windows, best single", [](auto& s) {
        s.gaussians.clear();
        s.fits = {{0.5f, false}, {1, false}};
        s.mix = false;
    });
    return list;
}

}  // namespace

int main(int argc, char** argv) {
    std::array<int, 2> size{};
    if (argc < 5 || argc % 2 == 0 || std::sscanf(argv[2], "%dx%d", &size[0], &size[1]) != 2) {
        fmt::print(stderr,
                   "usage: reconstruction_sweep SPP WxH SCENE REFERENCE [SCENE REFERENCE ...]\n");
        return 2;
    }
    try {
        std::vector<Case> cases;
        for (int i = 3; i < argc; i += 2)
            cases.push_back(load(std::atof(argv[1]), size, argv[i], argv[i + 1]));
        fmt::print("{:<30}  gain   relMSE x 1e5 per scene\n{:<38}", "", "raw");
        for (const Case& c : cases) fmt::print(" {:8.1f}", 1e5 * c.raw);
        for (const auto& [name, settings] : variants()) {
            double log_sum = 0;
            std::string each;
            for (const Case& c : cases) {
                const double e =
                    error(reconstruct(c.halves, c.spectrum, settings).color, c.reference);
                log_sum += std::log(c.raw / e);
                each += fmt::format(" {:8.1f}", 1e5 * e);
            }
            fmt::print("\n{:<30} {:6.2f} {}", name, std::exp(log_sum / double(cases.size())), each);
        }
        fmt::print("\n");
    } catch (const std::exception& e) {
        fmt::print(stderr, "reconstruction_sweep: {}\n", e.what());
        return 1;
    }
}
