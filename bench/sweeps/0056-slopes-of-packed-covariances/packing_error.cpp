/// The error that packing brings into the prediction: traces covariance paths and keeps their mean
/// both as doubles and as the film does, packed again after every path.
///
///     packing_error SCENE WIDTH HEIGHT PATHS
///
/// Prints, over the pixels with light, quantiles of how far the larger and the smaller principal
/// bandwidth of the spectrum after lens and shutter, and the interior count, come out: |log2 of
/// kept over exact|, with spectra below the widest filter's (16 pixels) raised to it, and the worst
/// pixel.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "core/parallel.h"
#include "frequency/replay.h"
#include "prediction/covariance_buffer.h"
#include "render/pass.h"
#include "support/load_scene.h"

namespace {

using namespace covtrace;

struct Scalars {
    double larger = 0, smaller = 0, count = 0;
};

Scalars scalars(const covariance::SymmetricMatrix5<double>& s) {
    const auto m = covariance::preintegrate(s);
    const double half = (m.xx + m.yy) / 2, root = std::hypot((m.xx - m.yy) / 2, m.xy);
    return {half + root, half - root, covariance::integration_count(s)};
}

struct Difference {
    double log2 = 0, exact = 0, kept = 0;
    int x = 0, y = 0;
};

void print(const char* name, std::vector<Difference>& all) {
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.log2 < b.log2; });
    const auto at = [&](double q) { return all[size_t(q * double(all.size() - 1))].log2; };
    const Difference& worst = all.back();
    std::printf(
        "%-8s median %.5f  99 %% %.5f  99.9 %% %.5f  worst %.5f at %d,%d (%.4g kept as %.4g)\n",
        name, at(0.5), at(0.99), at(0.999), worst.log2, worst.x, worst.y, worst.exact, worst.kept);
}

void run(const RenderScene& scene, uint32_t paths) {
    const OccluderQuery query(scene.geometry);
    const SceneSpectra spectra(scene);
    const PathReplay replay(scene, spectra, {nullptr, &query}, BrdfCovariance::local);
    const PassContext context{.scene = scene, .seed = 1, .max_depth = scene.description.max_depth};
    const PixelBounds region = render_region(scene.description.film);
    // A spectrum less than that of the widest filter changes nothing.
    const double least = 1 / (4 * sqr(2 * double(kPi) * 16));
    std::vector<Difference> larger, smaller, count;
    PathRecord record;
    PathResult path;
    for (int y = region.y0; y < region.y1; ++y)
        for (int x = region.x0; x < region.x1; ++x) {
            covariance::Accumulator<double> exact;
            PackedCovariance kept;
            for (uint32_t i = 0; i < paths; ++i) {
                take_sample(context, x, y, i, &record, path);
                const PathCovariance found = replay(record);
                exact.add(found.sigma, found.weight);
                covariance::Accumulator<double> sum;
                sum.add(kept.covariance(), double(kept.weight) * i);
                sum.add(found.sigma, found.weight);
                kept = {sum.mean(), float(sum.weight() / (i + 1.0))};
            }
            if (!(exact.weight() > 0)) continue;
            const Scalars a = scalars(exact.mean()), b = scalars(kept.covariance());
            const auto compare = [&](std::vector<Difference>& all, double was, double is) {
                all.push_back({std::abs(std::log2((is + least) / (was + least))), was, is, x, y});
            };
            compare(larger, a.larger, b.larger);
            compare(smaller, a.smaller, b.smaller);
            compare(count, a.count, b.count);
        }
    print("larger", larger);
    print("smaller", smaller);
    print("count", count);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 5) {
        std::fprintf(stderr, "usage: packing_error SCENE WIDTH HEIGHT PATHS\n");
        return 2;
    }
    try {
        const auto scene = load_scene(argv[1], argv[2], argv[3]);
        const ThreadLimit one(1);
        run(*scene, static_cast<uint32_t>(std::atoi(argv[4])));
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
