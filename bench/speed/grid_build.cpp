/// Time and memory of building the voxel grid and the outlines, on a compact mesh and on scattered
/// triangles.
///
///     grid_build [TRIANGLES [WIDTH ...]]
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <memory>
#include <vector>

#include "core/rng.h"
#include "occluders/query.h"
#include "occluders/voxel_grid.h"

namespace {

using namespace covtrace;

/// The peak of the whole process so far, MiB.
double peak_memory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

/// Seconds of the clock on the wall, and of all processors together.
struct Seconds {
    double wall = 0, processors = 0;
};
Seconds seconds(const std::function<void()>& body) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t before = std::clock();
    body();
    return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
            static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC};
}

SceneDescription scene_of(TriangleMesh mesh) {
    SceneDescription scene;
    ShapeDescription shape;
    shape.geometry = std::make_shared<const TriangleMesh>(std::move(mesh));
    scene.shapes.push_back(std::move(shape));
    return scene;
}

/// A bumpy ball, as one connected mesh.
TriangleMesh compact(size_t triangles) {
    TriangleMesh mesh;
    const auto rings = static_cast<uint32_t>(std::sqrt(static_cast<double>(triangles) / 4));
    const uint32_t around = 2 * rings;
    for (uint32_t i = 0; i <= rings; ++i)
        for (uint32_t j = 0; j <= around; ++j) {
            const float theta = kPi * static_cast<float>(i) / static_cast<float>(rings),
                        phi = 2 * kPi * static_cast<float>(j) / static_cast<float>(around);
            const float r = 1 + 0.1f * std::sin(9 * theta) * std::sin(7 * phi);
            mesh.positions.push_back(Vec3{std::sin(theta) * std::cos(phi),
                                          std::sin(theta) * std::sin(phi), std::cos(theta)} *
                                     r);
        }
    for (uint32_t i = 0; i < rings; ++i)
        for (uint32_t j = 0; j < around; ++j) {
            const uint32_t a = i * (around + 1) + j, b = a + around + 1;
            mesh.triangles.push_back({a, b, a + 1});
            mesh.triangles.push_back({a + 1, b, b + 1});
        }
    return mesh;
}

TriangleMesh scattered(size_t triangles) {
    TriangleMesh mesh;
    uint64_t state = 1;
    const auto next = [&state] {
        state = state * 6364136223846793005ull + 1442695040888963407ull;
        return static_cast<float>(state >> 40) * 0x1p-23f - 1;
    };
    const auto point = [&](float half) {
        const float x = half * next(), y = half * next(), z = half * next();
        return Vec3{x, y, z};
    };
    for (uint32_t i = 0; i < triangles; ++i) {
        const Vec3 middle = point(1);
        for (int k = 0; k < 3; ++k) mesh.positions.push_back(middle + point(0.004f));
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    return mesh;
}

}  // namespace

int main(int argc, char** argv) {
    const size_t triangles = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 1000000;
    std::vector<int> widths;
    for (int i = 2; i < argc; ++i) widths.push_back(std::atoi(argv[i]));
    if (widths.empty()) widths = {200, 400};
    std::printf("%-12s%10s%10s%10s%10s%12s%14s%16s\n", "mesh", "triangles", "what", "seconds",
                "of CPUs", "MiB", "parts", "peak so far MiB");
    for (const bool is_compact : {true, false}) {
        const Geometry geometry(scene_of(is_compact ? compact(triangles) : scattered(triangles)));
        const char* name = is_compact ? "compact" : "scattered";
        const auto report = [&](const char* what, Seconds time, size_t bytes, size_t parts) {
            std::printf("%-12s%10zu%10s%10.2f%10.2f%12.1f%14zu%16.0f\n", name, triangles, what,
                        time.wall, time.processors, static_cast<double>(bytes) / (1 << 20), parts,
                        peak_memory());
            std::fflush(stdout);
        };
        for (int width : widths) {
            std::unique_ptr<VoxelGrid> grid;
            const Seconds time = seconds([&] {
                grid = std::make_unique<VoxelGrid>(geometry, VoxelGridOptions{.width = width});
            });
            report(std::to_string(width).c_str(), time, grid->memory(), grid->occupied_voxels());
        }
        std::unique_ptr<OccluderQuery> query;
        size_t edges = 0;
        // Edges are found where searches come by; here all of them are.
        const Seconds time = seconds([&] {
            query = std::make_unique<OccluderQuery>(geometry);
            edges = query->edges();
        });
        report("outlines", time, query->memory(), edges);
    }
}
