/// Converges some pixels of an image much further than a whole image could be; usable_scale
/// measures filters at them.
///
///     converged_pixels [--every N] [--spp N] [--accuracy F] SCENE.pbrt LIKE.exr OUT.exr
///
/// One pixel, chosen by a hash, of every N x N (default 5) is sampled as `--method uniform` does,
/// in batches of 1024 samples with seeds of their own, until the standard deviation of its
/// luminance is below F (default 0.0025) times luminance + 0.01, estimated from the batches, or N
/// samples (default 65536) are taken. The size is that of LIKE. OUT holds R, G, B, of which
/// `inview.R`, `inview.G`, `inview.B` from emitters in view, `variance.Y` (of the luminance) and
/// `samples.Y`, zero where nothing was sampled.
#include <fmt/format.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "core/hash.h"
#include "core/parallel.h"
#include "image/image.h"
#include "pbrt/read_scene.h"
#include "render/job.h"
#include "render/overrides.h"
#include "render/session.h"

using namespace covtrace;

namespace {

constexpr uint32_t kBatch = 1024;
constexpr int kFewestBatches = 8;
constexpr uint64_t kFirstSeed = 500000;

struct Arguments {
    int every = 5, most_batches = 64;
    double accuracy = 0.0025;
    std::vector<const char*> files;
};

struct ConvergedPixel {
    Rgb mean, in_view;
    double variance = 0;  ///< of the mean's luminance
    int batches = 0;
};

ConvergedPixel converge(PassContext context, int x, int y, const Arguments& a) {
    ConvergedPixel p;
    double mean = 0, squares = 0;  // of the batches' luminance
    PathResult path;
    while (p.batches < a.most_batches) {
        context.seed = kFirstSeed + uint64_t(p.batches);
        Film batch({0, 0, 1, 1}, {.in_view = true});
        for (uint32_t i = 0; i < kBatch; ++i) {
            FilmSample s = take_sample(context, x, y, i, nullptr, path);
            if (!is_finite(s.radiance)) s.radiance = s.in_view = Rgb(0);
            batch.add(0, s);
        }
        ++p.batches;
        p.mean += (batch.pixels[0].mean - p.mean) / float(p.batches);
        p.in_view += (batch.in_view[0] - p.in_view) / float(p.batches);
        const double value = luminance(batch.pixels[0].mean), deviation = value - mean;
        mean += deviation / p.batches;
        squares += deviation * (value - mean);
        p.variance = p.batches > 1 ? squares / (p.batches * (p.batches - 1.0)) : 0;
        if (p.batches >= kFewestBatches && std::sqrt(p.variance) < a.accuracy * (mean + 0.01))
            break;
    }
    return p;
}

void run(const Arguments& a) {
    const Image like = read_image(a.files[1]);
    SceneDescription description = read_pbrt(a.files[0]);
    SceneOverrides overrides;
    overrides.resolution = {like.display.width(), like.display.height()};
    apply(overrides, description);
    const RenderScene scene(std::move(description));
    const PassContext context = pass_context(scene, RenderOptions());

    Image out;
    out.data = like.data;
    out.display = like.display;
    for (const char* name :
         {"R", "G", "B", "inview.R", "inview.G", "inview.B", "variance.Y", "samples.Y"})
        out.add_channel(name);
    const int blocks_x = (out.width() + a.every - 1) / a.every;
    const int blocks_y = (out.height() + a.every - 1) / a.every;
    parallel_for(int64_t(blocks_x) * blocks_y, [&](int64_t block) {
        const uint64_t h = hash_combine(kFirstSeed, uint64_t(block));
        const int x = int(block % blocks_x) * a.every + int(h % uint64_t(a.every));
        const int y = int(block / blocks_x) * a.every + int((h >> 32) % uint64_t(a.every));
        if (x >= out.width() || y >= out.height()) return;
        const ConvergedPixel p = converge(context, out.data.x0 + x, out.data.y0 + y, a);
        const size_t i = size_t(y) * size_t(out.width()) + size_t(x);
        for (int k = 0; k < 3; ++k) {
            out.channels[size_t(k)].values[i] = p.mean[k];
            out.channels[size_t(k) + 3].values[i] = p.in_view[k];
        }
        out.channels[6].values[i] = float(p.variance);
        out.channels[7].values[i] = float(p.batches) * float(kBatch);
    });
    write_exr(out, a.files[2]);
}

}  // namespace

int main(int argc, char** argv) {
    Arguments a;
    for (int i = 1; i < argc; ++i) {
        if (!std::strcmp(argv[i], "--every") && i + 1 < argc)
            a.every = std::max(1, std::atoi(argv[++i]));
        else if (!std::strcmp(argv[i], "--spp") && i + 1 < argc)
            a.most_batches = std::max(kFewestBatches, std::atoi(argv[++i]) / int(kBatch));
        else if (!std::strcmp(argv[i], "--accuracy") && i + 1 < argc)
            a.accuracy = std::atof(argv[++i]);
        else
            a.files.push_back(argv[i]);
    }
    if (a.files.size() != 3) {
        fmt::print(stderr,
                   "usage: converged_pixels [--every N] [--spp N] [--accuracy F] SCENE LIKE OUT\n");
        return 2;
    }
    try {
        run(a);
    } catch (const std::exception& e) {
        fmt::print(stderr, "converged_pixels: {}\n", e.what());
        return 1;
    }
}
