// The snippets of README.md, "Ten minutes", compiled as they stand there (CMakeLists.txt cuts them
// out) in a tracer that has vectors of its own: a floor, a lamp over it and a black sky.
#include <covariance/renderer.hpp>

#include "support.h"

namespace {

namespace cov = covariance;

struct Vec {
    double x = 0, y = 0, z = 0;
};
Vec operator-(const Vec& a) {
    return {-a.x, -a.y, -a.z};
}
Vec& operator+=(Vec& a, const Vec& b) {
    return a = {a.x + b.x, a.y + b.y, a.z + b.z};
}
Vec operator/(const Vec& a, double s) {
    return {a.x / s, a.y / s, a.z / s};
}

cov::OccluderGrid<double> grid_of_scene() {
    const Vec a{-1, -1, 0}, b{1, -1, 0}, c{1, 1, 0}, velocity, center{0.25, 0, 0.2};
    const double radius = 0.2, shutter_open = 0, shutter_middle = 0.01, shutter_close = 0.02;
#include "grid.inc"
    return grid;
}

/// Values of a path's vertices, counted from 1; asked for a vertex that is not there it throws.
template <typename T>
struct OfVertices {
    std::vector<T> values;
    const T& operator[](int i) const { return values.at(std::size_t(i) - 1); }
};

/// Paths of up to two vertices on the floor, the camera above it.
struct Walk {
    cov::OccluderGrid<double> grid = grid_of_scene();
    cov::ThinLens<double> camera{{1, 0, 0}, {0, 1, 0}, {0, 0, -1}, 4, 0.1, 50, 50, 0.02};
    cov::Surface<double> lamp_surface{Vec{0, 0, -1}, Vec{1, 0, 0}, Vec{0, 1, 0}, {}};
    cov::CovarianceImage<float> scattered{1, 1};

    bool add(int n, bool ends_at_lamp) {
        const Vec point_on_lens{0, 0.01, 4}, escape{0, 0, n > 0 ? 1.0 : -1.0},
            way_of_light = -escape;
        OfVertices<Vec> position{{{0, 0, 0}, {0, 0, 1}}};
        position.values.resize(std::size_t(n));
        if (ends_at_lamp) position.values.push_back({0, 0, n > 0 ? 2.0 : 0.0});
        const cov::Surface<double> up{Vec{0, 0, 1}, Vec{1, 0, 0}, Vec{0, 1, 0}, {}};
        const OfVertices<cov::Surface<double>> surface{{up, up}};
        const OfVertices<cov::Motion<double>> motion{{{}, {}}};
        const OfVertices<cov::Sym2<double>> texture{{{}, {}}};
        const OfVertices<Vec> to_camera{{{0, 0, 1}, {0, 0, -1}}};
        constexpr double diffuse = cov::diffuse_receiver<double>, radiance = 1, time = 0.001;
        const OfVertices<double> window{{diffuse, diffuse}};
        const int x = 0, y = 0;
        const float before = scattered.weight[0];
#include "walk.inc"
        return scattered.weight[0] == before + 1;
    }
};

TEST(Readme, WalksBackFromLampAndSky) {
    for (const int n : {0, 1, 2})
        for (const bool ends_at_lamp : {false, true}) {
            Walk walk;
            EXPECT_TRUE(walk.add(n, ends_at_lamp)) << n << ends_at_lamp;
            // The ball stands beside every way, less than a cell from it.
            EXPECT_GT(walk.scattered.covariance[0](0, 0), 0) << n << ends_at_lamp;
        }
}

TEST(Readme, PlansTwoPassesAndGathersTheirMeans) {
    constexpr std::size_t pixels = 16;
    constexpr int samples = 16;
    cov::CovarianceImage<float> scattered(16, 1), in_view(16, 1);
    for (int x = 0; x < 12; ++x)
        scattered.add(x, 0, cov::SymmetricMatrix5<double>::diagonal(0.01, 0.01, 0, 0, 0), 1.0);
    std::vector<bool> saw_nothing(pixels);
    for (std::size_t i = 12; i < pixels; ++i) saw_nothing[i] = true;
    const Vec color{1, 2, 3};
    std::vector<Vec> sum_scattered(pixels, Vec{4, 8, 12}), sum_in_view(pixels),
        mean_scattered(pixels), mean_in_view(pixels);
    const auto trace = [&](std::size_t pixel, std::uint32_t paths) {
        for (std::uint32_t k = 0; k < paths; ++k) sum_scattered[pixel] += color;
    };
#include "image.inc"
    std::size_t sum = 0;
    for (const std::uint32_t c : counts) sum += c;
    EXPECT_EQ(sum, samples * pixels);
    EXPECT_EQ(counts[14], 4U);
    for (const auto& c : image) EXPECT_NEAR(c.y, 2, 1e-5);
}

}  // namespace
