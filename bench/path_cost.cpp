/// What a covariance path costs beside a radiance path: traces every k-th pixel of every k-th row
/// in each way under callgrind, with the counters on for the paths alone. bench/path_cost reads
/// what it leaves.
///
///     valgrind --tool=callgrind --instr-atstart=no path_cost SCENE WIDTH HEIGHT EVERY PATHS KIND
///     ...
///
/// KIND: uniform, none, query, or the width of a grid. One dump per kind, in this order.
#include <valgrind/callgrind.h>

#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>

#include "core/parallel.h"
#include "frequency/replay.h"
#include "load_scene.h"
#include "render/pass.h"

namespace {

using namespace covtrace;

void run(const RenderScene& scene, const std::string& kind, int every, uint32_t paths) {
    std::optional<VoxelGrid> grid;
    std::optional<OccluderQuery> query;
    if (kind == "query")
        query.emplace(scene.geometry);
    else if (kind != "none" && kind != "uniform")
        grid.emplace(scene.geometry, VoxelGridOptions{.width = std::atoi(kind.c_str())});
    const PathReplay replay(scene, {grid ? &*grid : nullptr, query ? &*query : nullptr},
                            BrdfCovariance::local);
    const PassContext context{.scene = scene, .seed = 1, .max_depth = scene.description.max_depth};
    const PixelBounds region = render_region(scene.description.film);
    PathRecord record;
    PathResult path;
    const ThreadLimit one(1);
    const auto trace = [&] {
        double sum = 0;
        for (int y = region.y0 + every / 2; y < region.y1; y += every)
            for (int x = region.x0 + every / 2; x < region.x1; x += every)
                for (uint32_t i = 0; i < paths; ++i)
                    if (kind == "uniform") {
                        sum += take_sample(context, x, y, i, nullptr, path).radiance.g;
                    } else {
                        take_sample(context, x, y, i, &record, path);
                        sum += replay(record).weight;
                    }
        return sum;
    };
    trace();  // spectra of textures are made when they are first asked for
    CALLGRIND_START_INSTRUMENTATION;
    const double sum = trace();
    CALLGRIND_STOP_INSTRUMENTATION;
    CALLGRIND_DUMP_STATS_AT(kind.c_str());
    std::printf("%s %g\n", kind.c_str(), sum);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 7) {
        std::fprintf(stderr, "usage: path_cost SCENE WIDTH HEIGHT EVERY PATHS KIND ...\n");
        return 2;
    }
    try {
        const auto scene = load_scene(argv[1], argv[2], argv[3]);
        for (int i = 6; i < argc; ++i)
            run(*scene, argv[i], std::atoi(argv[4]), static_cast<uint32_t>(std::atoi(argv[5])));
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
