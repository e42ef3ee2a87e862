/// The cost of a covariance path beside a radiance path: traces every k-th pixel of every k-th row
/// in each way. The script path_cost beside this file reads the output.
///
///     valgrind --tool=callgrind --instr-atstart=no path_cost SCENE WIDTH HEIGHT EVERY PATHS ROUNDS
///     KIND ...
///
/// KIND: uniform, none, query, or the width of a grid. Under callgrind the program leaves one dump
/// per kind, in this order, with the counters on for the paths alone. Without callgrind it prints
/// for every round, in which the kinds are traced in turn, the CPU seconds of each.
#include <valgrind/callgrind.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <deque>
#include <optional>
#include <stdexcept>
#include <string>

#include "core/parallel.h"
#include "frequency/replay.h"
#include "render/pass.h"
#include "support/load_scene.h"

namespace {

using namespace covtrace;

/// One kind of path, ready to be traced.
class Way {
  public:
    Way(const RenderScene& scene, const SceneSpectra& spectra, const std::string& kind)
        : kind_(kind),
          grid_(grid_of(scene, kind)),
          query_(query_of(scene, kind)),
          replay_(scene, spectra, {grid_ ? &*grid_ : nullptr, query_ ? &*query_ : nullptr},
                  BrdfCovariance::local),
          context_{.scene = scene, .seed = 1, .max_depth = scene.description.max_depth} {}
    const std::string& kind() const { return kind_; }

    /// Traces all paths and returns a sum over them, so that nothing is optimised away.
    double trace(int every, uint32_t paths) {
        const PixelBounds region = render_region(context_.scene.description.film);
        double sum = 0;
        for (int y = region.y0 + every / 2; y < region.y1; y += every)
            for (int x = region.x0 + every / 2; x < region.x1; x += every)
                for (uint32_t i = 0; i < paths; ++i)
                    if (kind_ == "uniform") {
                        sum += take_sample(context_, x, y, i, nullptr, path_).radiance.g;
                    } else {
                        take_sample(context_, x, y, i, &record_, path_);
                        sum += replay_(record_).weight;
                    }
        return sum;
    }

  private:
    static std::optional<OccluderQuery> query_of(const RenderScene& scene,
                                                 const std::string& kind) {
        if (kind != "query") return std::nullopt;
        return std::optional<OccluderQuery>(std::in_place, scene.geometry);
    }
    static std::optional<VoxelGrid> grid_of(const RenderScene& scene, const std::string& kind) {
        if (kind == "uniform" || kind == "none" || kind == "query") return std::nullopt;
        return std::optional<VoxelGrid>(std::in_place, scene.geometry,
                                        VoxelGridOptions{.width = std::atoi(kind.c_str())});
    }

    std::string kind_;
    std::optional<VoxelGrid> grid_;
    std::optional<OccluderQuery> query_;
    PathReplay replay_;
    PassContext context_;
    PathRecord record_;
    PathResult path_;
};

void count(Way& way, int every, uint32_t paths) {
    CALLGRIND_START_INSTRUMENTATION;
    const double sum = way.trace(every, paths);
    CALLGRIND_STOP_INSTRUMENTATION;
    CALLGRIND_DUMP_STATS_AT(way.kind().c_str());
    std::printf("%s %g\n", way.kind().c_str(), sum);
}

double cpu_seconds(Way& way, int every, uint32_t paths) {
    const std::clock_t start = std::clock();
    const double sum = way.trace(every, paths);
    const std::clock_t end = std::clock();
    if (!std::isfinite(sum)) throw std::runtime_error("a path has no finite sum");
    return double(end - start) / CLOCKS_PER_SEC;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 8) {
        std::fprintf(stderr, "usage: path_cost SCENE WIDTH HEIGHT EVERY PATHS ROUNDS KIND ...\n");
        return 2;
    }
    try {
        const auto scene = load_scene(argv[1], argv[2], argv[3]);
        const int every = std::atoi(argv[4]), rounds = std::atoi(argv[6]);
        const auto paths = static_cast<uint32_t>(std::atoi(argv[5]));
        const ThreadLimit one(1);
        const SceneSpectra spectra(*scene);
        std::deque<Way> ways;
        for (int i = 7; i < argc; ++i) ways.emplace_back(*scene, spectra, argv[i]);
        // Spectra of textures are made when they are first asked for.
        for (Way& way : ways) way.trace(every, paths);
        if (RUNNING_ON_VALGRIND) {
            for (Way& way : ways) count(way, every, paths);
            return 0;
        }
        for (int round = 0; round < rounds; ++round) {
            for (Way& way : ways) std::printf(" %.6f", cpu_seconds(way, every, paths));
            std::printf("\n");
        }
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
