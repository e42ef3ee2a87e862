// The snippets of README.md, "Ten minutes", compiled as they stand there (CMakeLists.txt cuts them
// out) in a tracer that has vectors of its own: a floor, a lamp over it and a black sky.
#include <covariance/renderer.hpp>

#include "support.h"

namespace {

namespace cov = covariance;

struct Vec {
    double x = 0, y = 0, z = 0;
};

cov::OccluderGrid<double> grid_of_scene() {
    const Vec a{-1, -1, 0}, b{1, -1, 0}, c{1, 1, 0}, velocity, center{0.25, 0, 0.2};
    const double radius = 0.2, shutter_open = 0, shutter_middle = 0.01, shutter_close = 0.02;
#include "grid.inc"
    return grid;
}

/// A camera above the floor, which lies under a lamp of two sides and a ball.
struct Scene {
    cov::OccluderGrid<double> grid = grid_of_scene();
    cov::ThinLens<double> camera{{1, 0, 0}, {0, 1, 0}, {0, 0, -1}, 4, 0.1, 50, 50, 0.02};
};

void fill(cov::Path<double>& path, bool emits) {
    const Vec point_on_lens{0, 0.01, 4}, position{0, 0, 0}, normal{0, 0, 1}, to_camera{0, 0, 1},
        direction{0, 0, -1}, side_1{1, 0, 0}, side_2{0, 1, 0}, point_on_lamp{0.25, 0, 2},
        radiance{1, 2, 3}, sampled_radiance{2, 2, 2};
    const double time = 0.001, radius = 0.2;
#include "path.inc"
}

TEST(Readme, PathsAreFilledAsTheyAreTraced) {
    const Scene scene;
    cov::Path<double> path;
    fill(path, true);
    ASSERT_EQ(path.vertices().size(), 1U);
    EXPECT_EQ(path.ends().size(), 3U);
    for (const cov::Part part : {cov::Part::scattered, cov::Part::in_view}) {
        fill(path, false);
        if (part == cov::Part::scattered) path.last_vertex().lobe = cov::Lobe<double>::diffuse();
        const auto [sigma, weight] = cov::covariance_of(path, part, scene.grid, scene.camera);
        EXPECT_DOUBLE_EQ(weight, 4);
        // The ball stands beside every way, less than a cell from it.
        EXPECT_GT(sigma(0, 0), 0);
    }
}

TEST(Readme, PlansTwoPassesAndFiltersTheirMeans) {
    const Scene scene;
    const cov::OccluderGrid<double>& grid = scene.grid;
    const cov::ThinLens<double>& camera = scene.camera;
    constexpr int width = 16, height = 4;
    constexpr int samples = 16;
    cov::Path<double> path;
    std::size_t taken = 0;
    const auto trace = [&](int, int, cov::Path<double>& p) {
        fill(p, false);
        ++taken;
    };
#include "image.inc"
    EXPECT_EQ(taken, std::size_t(samples * width * height));
    EXPECT_EQ(counts.size(), std::size_t(width * height));
    for (const auto& c : image) EXPECT_NEAR(c.y, 4, 1e-5);
}

}  // namespace
