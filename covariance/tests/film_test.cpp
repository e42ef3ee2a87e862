// The film that plans and filters, on images that are known.
#include <covariance/renderer.hpp>

#include "support.h"

namespace support {
namespace {

using namespace covariance;

struct Camera {
    ThinLens<double> lens{{1, 0, 0}, {0, 1, 0}, {0, 0, -1}, 4, 0, 50, 50, 0};
    OccluderGrid<double> grid;
    Camera() { grid.build(); }
};

/// A path to a floor with a texture, under a lamp.
void meet_floor(Path<double>& path, double texture) {
    path.begin({0, 0, 4});
    path.add_vertex({{0, 0, 0},
                     surface_with_normal<double>({0, 0, 1}),
                     {0, 0, 1},
                     Lobe<double>::diffuse(),
                     Sym2::diagonal(texture, texture),
                     {}});
    path.add_lamp(ball_lamp(1), {0, 0, 5}, {1, 2, 3});
}

TEST(Film, PlansMoreSamplesWhereCovariancesAskForThem) {
    const Camera camera;
    constexpr int n = 24;
    Film<double> film(n, n, 16);
    Path<double> path;
    for (int k = 0; k < 2; ++k)
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) {
                meet_floor(path, x < n / 2 ? 0.01 : 1000);
                film.add(x, y, path, camera.grid, camera.lens);
            }
    const auto counts = film.plan();
    std::int64_t sum = 0;
    for (const std::uint32_t c : counts) sum += c;
    EXPECT_EQ(sum, 16 * n * n);
    EXPECT_GT(counts[12 * n + 20], 2 * counts[12 * n + 4]);
    EXPECT_GT(filter_size(film.filters().scattered.covariance[12 * n + 4]),
              2 * filter_size(film.filters().scattered.covariance[12 * n + 20]));
}

TEST(Film, LeavesPixelsAloneThatMeetNothing) {
    const Camera camera;
    constexpr int n = 12;
    Film<double> film(n, n, 8);
    Path<double> path;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            if (x < n / 2)
                meet_floor(path, 0.1);
            else
                path.begin({0, 0, 4});
            film.add(x, y, path, camera.grid, camera.lens);
        }
    const auto counts = film.plan();
    EXPECT_GT(counts[6 * n + 2], 8U);
    // Beside the border they may be met yet.
    EXPECT_GT(counts[6 * n + n / 2], 1U);
    EXPECT_EQ(counts[6 * n + n / 2 + 1], 1U);
    EXPECT_EQ(counts[6 * n + n - 1], 1U);
}

TEST(Film, FiltersMeansOfBothPartsAndKeepsAnEvenImage) {
    const Camera camera;
    constexpr int n = 16;
    Film<double> film(n, n, 4);
    Path<double> path;
    for (int k = 0; k < 3; ++k)
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) {
                // Noise of the first two samples that the third one takes back; a lamp in view.
                const double noise = k == 2 ? -1 : 0.5;
                path.begin({0, 0, 4});
                path.add_lamp(ball_lamp(1), {0, 0, 2}, {0.25, 0, 0});
                path.add_vertex({{0, 0, 0}, surface_with_normal<double>({0, 0, 1}), {0, 0, 1}});
                path.add_lamp(ball_lamp(1), {0, 0, 5}, {1 + noise, 2, 3});
                if (k < 2)
                    film.add(x, y, path, camera.grid, camera.lens);
                else
                    film.add(x, y, path);
            }
    EXPECT_EQ(film.counts()[5], 3U);
    EXPECT_GT(film.covariances(Part::in_view).weight[5], 0.1F);
    EXPECT_GT(film.covariances(Part::scattered).weight[5], 1.F);
    const auto raw = film.raw(), filtered = film.filtered();
    for (std::size_t i = 0; i < raw.size(); ++i) {
        EXPECT_NEAR(raw[i].x, 1.25, 1e-12);
        EXPECT_NEAR(raw[i].y, 2, 1e-12);
        EXPECT_NEAR(filtered[i].x, 1.25, 1e-6);
        EXPECT_NEAR(filtered[i].z, 3, 1e-6);
    }
}

TEST(Film, SmoothsNoiseWhereFiltersAreWide) {
    const Camera camera;
    constexpr int n = 32;
    Film<double> film(n, n, 16);
    Path<double> path;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            meet_floor(path, 0.01);
            const double noise = (x + y) % 2 == 0 ? 0.5 : -0.5;
            path.add_lamp(ball_lamp(1), {0, 0, 5}, {noise, noise, noise});
            film.add(x, y, path, camera.grid, camera.lens);
        }
    const auto filtered = film.filtered();
    EXPECT_GT(std::abs(film.raw()[16 * n + 16].x - 1), 0.4);
    EXPECT_NEAR(filtered[16 * n + 16].x, 1, 0.02);
}

}  // namespace
}  // namespace support
