// Compares reconstructions of the same samples, without rendering again for each:
//
//     reconstruction_sweep REFERENCE.exr REFERENCE2.exr FILM [REFERENCE REFERENCE2 FILM ...]
//
// The films are those of `covtrace render --method hybrid --checkpoint FILM`. Prints for every set
// of candidates and selector the trimmed relMSE per scene, the geometric mean of raw error over
// error, and how good the image's own estimate of its error is: mean true over mean estimated
// squared error, and in how many of 20 bins of tiles (16 x 16 pixels, 8 x 8 where that makes fewer
// than 200), sorted by the estimate, it lies between 0.7 and 1.4. The references are two
// independent images, whose own noise is taken out. docs/decisions/archive/0061 has the table.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "image/compare.h"
#include "reconstruction/luminance.h"
#include "reconstruction/selector.h"
#include "support/error_bins.h"
#include "support/hybrid_samples.h"

using namespace covtrace;

namespace {

struct Case {
    Halves halves;
    std::vector<Covariance2> spectrum;
    std::array<Image, 2> reference;
    double noise = 0;  // of one reference
    double raw = 0;

    double error(const ColorPlanes& color) const;
    /// The squared error of every pixel over I^2 + 0.01, without the references' noise.
    Plane true_error(const ColorPlanes& color) const;
};

double Case::error(const ColorPlanes& color) const {
    Image image;
    image.data = reference[0].data;
    image.display = reference[0].display;
    for (size_t c = 0; c < 3; ++c)
        image.add_channel(std::string(1, "RGB"[c])).values = color[c].values;
    return 0.5 * (compare(image, reference[0]).relmse_trimmed +
                  compare(image, reference[1]).relmse_trimmed) -
           noise;
}

Plane Case::true_error(const ColorPlanes& color) const {
    Plane e(color[0].width, color[0].height);
    for (size_t i = 0; i < e.size(); ++i) {
        const Rgb a = reference[0].rgb(i), b = reference[1].rgb(i), mean = 0.5f * (a + b);
        for (int c = 0; c < 3; ++c)
            e[i] += (color[size_t(c)][i] - a[c]) * (color[size_t(c)][i] - b[c]) /
                    (sqr(mean[c]) + kDarkSquared) / 3;
    }
    return e;
}

Case load(const char* const* files) {
    HybridSamples samples = read_hybrid_samples(files[2]);
    Case c{std::move(samples.halves),
           std::move(samples.spectrum),
           {read_image(files[0]), read_image(files[1])}};
    for (const Image& r : c.reference)
        if (r.pixel_count() != c.halves[0].count.size())
            throw Error(ErrorKind::usage,
                        fmt::format("{}: has other pixels than the references", files[2]));
    c.noise = compare(c.reference[0], c.reference[1]).relmse_trimmed / 2;
    ColorPlanes raw = c.halves[0].color;
    for (size_t k = 0; k < 3; ++k)
        for (size_t i = 0; i < raw[k].size(); ++i)
            raw[k][i] = 0.5f * (raw[k][i] + c.halves[1].color[k][i]);
    c.raw = c.error(raw);
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
    for (float sigma : {3.0f, 9.0f})
        add(fmt::format("judged over sigma {}", sigma), [&](auto& s) { s.likeness.sigma = sigma; });
    for (float any : {0.02f, 0.1f, 1.0f})
        add(fmt::format("unlike pixels count {}", any), [&](auto& s) { s.likeness.any = any; });
    for (float k : {0.35f, 0.7f, 1.0f})
        add(fmt::format("noisy features: k = {}", k), [&](auto& s) { s.candidates.fits[0].k = k; });
    add("a shaped window with them, too",
        [](auto& s) { s.candidates.fits[2].noise = FeatureNoise::kept; });
    add("filtered features alone", [](auto& s) {
        for (auto& fit : s.candidates.fits) fit.noise = FeatureNoise::filtered;
    });
    add("without the wider Gaussian", [](auto& s) { s.candidates.gaussians = {0.5f}; });
    add("without the narrower Gaussian", [](auto& s) { s.candidates.gaussians = {1}; });
    add("without the Gaussians", [](auto& s) { s.candidates.gaussians.clear(); });
    add("without shaped windows", [](auto& s) {
        for (auto& fit : s.candidates.fits) fit.shaped = false;
    });
    add("Gaussians alone", [](auto& s) { s.candidates.fits.clear(); });
    list.emplace_back("plain windows, mixed", plain_regression());
    list.back().second.mix = true;
    list.emplace_back("plain windows, best single", plain_regression());
    return list;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 4 || argc % 3 != 1) {
        fmt::print(stderr, "usage: reconstruction_sweep REFERENCE REFERENCE2 FILM [...]\n");
        return 2;
    }
    try {
        std::vector<Case> cases;
        for (int i = 1; i < argc; i += 3) cases.push_back(load(argv + i));
        fmt::print("{:<30}  gain   per scene: relMSE x 1e5 (true / estimated, bins)\n{:<38}", "",
                   "raw");
        for (const Case& c : cases) fmt::print(" {:8.1f}          ", 1e5 * c.raw);
        for (const auto& [name, settings] : variants()) {
            double log_sum = 0;
            std::string each;
            for (const Case& c : cases) {
                const HybridImage image = reconstruct(c.halves, c.spectrum, settings);
                const double e = c.error(image.color);
                log_sum += std::log(c.raw / e);
                const Plane real = c.true_error(image.color);
                const ErrorBins bins = error_bins(
                    error_tiles(image.relative_error, real, tile_side(real.width, real.height)));
                each +=
                    fmt::format(" {:8.1f} ({:4.2f}, {:2})", 1e5 * e, bins.all.ratio(), bins.good);
            }
            fmt::print("\n{:<30} {:6.2f} {}", name, std::exp(log_sum / double(cases.size())), each);
        }
        fmt::print("\n");
    } catch (const std::exception& e) {
        fmt::print(stderr, "reconstruction_sweep: {}\n", e.what());
        return 1;
    }
}
