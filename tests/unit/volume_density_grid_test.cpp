/// Densities between the values of a lattice, and their integrals along rays.
#include "volume/density_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/rng.h"
#include "volume/cloud.h"

namespace covtrace {
namespace {

constexpr LatticePlace kFirst{-3, 5, 0}, kLast{14, 12, 20};

float value_at(const LatticePlace& p) {
    for (size_t a = 0; a < 3; ++a)
        if (p[a] < kFirst[a] || p[a] > kLast[a]) return 0;
    const uint64_t hash = mix_bits(uint64_t((p[0] + 50) + 100 * ((p[1] + 50) + 100 * (p[2] + 50))));
    return hash % 3 == 0 ? 0 : to_unit_float(uint32_t(hash >> 32));
}

/// A lattice that is turned, scaled and moved, as a medium's space may be.
Transform lattice_from_space() {
    return Transform::translate({1, 7, 3}) * Transform::rotate(40, {1, 2, 3}) *
           Transform::scale(3, 2, 5);
}

DensityGrid turned_grid(const Bounds3& bounds) {
    return {lattice_from_space(), bounds, {kFirst, kLast, value_at}};
}

/// The density by its definition.
float between_values(Vec3 p, const Bounds3& bounds) {
    if (!bounds.contains(p)) return 0;
    float sum = 0;
    for (int i = 0; i < 8; ++i) {
        LatticePlace corner;
        float weight = 1;
        for (int a = 0; a < 3; ++a) {
            const float floor = std::floor(p[a]), t = p[a] - floor;
            corner[size_t(a)] = int(floor) + (i >> a & 1);
            weight *= (i >> a & 1) ? t : 1 - t;
        }
        sum += weight * value_at(corner);
    }
    return sum;
}

Vec3 random_point(Rng& rng, float size) {
    const Vec2 u = rng.next_2d(), v = rng.next_2d();
    return Vec3{u.x - 0.5f, u.y - 0.5f, v.x - 0.5f} * (2 * size);
}

/// Bounds that cut cells in two, as those of pbrt's grids do.
const Bounds3 kBounds{{-3.5f, 4.5f, -0.5f}, {14.5f, 12.5f, 20.5f}};

TEST(DensityGrid, IsLinearBetweenItsValues) {
    const DensityGrid grid = turned_grid(kBounds);
    const Transform space_from_lattice = lattice_from_space().inverse();
    Rng rng(1);
    int inside = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3 p = Vec3{5, 8, 10} + random_point(rng, 13);
        const float expected = between_values(p, kBounds);
        inside += expected > 0;
        EXPECT_NEAR(grid.at(space_from_lattice.point(p)), expected, 2e-4f)
            << p.x << " " << p.y << " " << p.z;
    }
    EXPECT_GT(inside, 1000);
}

TEST(DensityGrid, IntegralsAlongRaysAreThoseOfTheDensity) {
    const DensityGrid grid = turned_grid(kBounds);
    const Transform to_lattice = lattice_from_space(), back = to_lattice.inverse();
    Rng rng(2);
    int met = 0;
    for (int i = 0; i < 300; ++i) {
        const Vec3 from = back.point(Vec3{5, 8, 10} + random_point(rng, 20)),
                   to = back.point(Vec3{5, 8, 10} + random_point(rng, 6));
        Vec3 direction = normalize(to - from);
        if (i % 10 == 0) direction = normalize(back.vector({0, 0, i % 20 ? 1.0f : -1.0f}));
        const float length = i % 3 == 0 ? kInfinity : 4;
        const float end = std::min(length, 30.0f);
        constexpr int kSteps = 40000;
        double expected = 0;
        for (int k = 0; k < kSteps; ++k) {
            const float t = end * (float(k) + 0.5f) / kSteps;
            expected += double(between_values(to_lattice.point(from + t * direction), kBounds)) *
                        end / kSteps;
        }
        met += expected > 0.1;
        EXPECT_NEAR(grid.column(from, direction, length), expected, 1e-3 * (1 + expected)) << i;
    }
    EXPECT_GT(met, 100);
}

TEST(DensityGrid, DistancesAreWhereTheIntegralIsReached) {
    const DensityGrid grid = turned_grid(kBounds);
    const Transform back = lattice_from_space().inverse();
    Rng rng(3);
    for (int i = 0; i < 500; ++i) {
        const Vec3 from = back.point(Vec3{5, 8, 10} + random_point(rng, 20)),
                   to = back.point(Vec3{5, 8, 10} + random_point(rng, 6));
        const Vec3 direction = normalize(to - from);
        const float whole = grid.column(from, direction, 20);
        if (!(whole > 0.01f)) continue;
        const std::array<float, 4> columns{0.1f * whole, 0.5f * whole, 0.9f * whole, 1.1f * whole};
        std::array<float, 4> found;
        grid.distances(from, direction, 20, columns.data(), found.data(), 4);
        for (size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(grid.column(from, direction, found[k]), columns[k], 1e-4f * whole);
            EXPECT_EQ(found[k], grid.distance(from, direction, 20, columns[k]));
        }
        EXPECT_EQ(found[3], kInfinity);
    }
}

TEST(DensityGrid, LargeEmptySpaceTakesNoMemoryOfValues) {
    // Two balls of 4 places far apart, along a diagonal of a box of 2000 along each side
    const auto value = [](const LatticePlace& p) {
        const auto near = [&](int c) {
            return sqr(float(p[0] - c)) + sqr(float(p[1] - c)) + sqr(float(p[2] - c)) < 16;
        };
        return near(20) || near(1980) ? 1.0f : 0.0f;
    };
    const auto is_empty = [](const LatticePlace& first, const LatticePlace& last) {
        const auto away = [&](int c) {
            for (size_t a = 0; a < 3; ++a)
                if (last[a] < c - 4 || first[a] > c + 4) return true;
            return false;
        };
        return away(20) && away(1980);
    };
    const DensityGrid grid(Transform(), {{0, 0, 0}, {2000, 2000, 2000}},
                           {{0, 0, 0}, {1999, 1999, 1999}, value, is_empty});
    EXPECT_LT(grid.bytes(), size_t(80) << 20);
    EXPECT_EQ(grid.largest(), 1);
    const Vec3 diagonal = normalize(Vec3{1, 1, 1});
    const float one = grid.column({20, 20, 12}, {0, 0, 1}, 16);
    EXPECT_NEAR(one, 7, 1e-4);  // seven values of 1, and half a cell on either side
    EXPECT_NEAR(grid.column({0, 0, 0}, diagonal, kInfinity),
                2 * grid.column({10, 10, 10}, diagonal, 50), 1e-3);
}

TEST(DensityGrid, StopsWhereNothingIsLeft) {
    const DensityGrid grid(Transform(), {{0, 0, 0}, {100, 1, 1}},
                           {{0, 0, 0}, {100, 1, 1}, [](const LatticePlace&) { return 1.0f; }});
    const float column = grid.column({-1, 0.5f, 0.5f}, {1, 0, 0}, kInfinity, 5);
    EXPECT_GT(column, 5);
    EXPECT_LT(column, 7);
}

TEST(Cloud, ItsGridIsItsDensity) {
    const Cloud cloud{{{-1, 0, 0}, {1, 1, 1}}, 2, 1, 1};
    const DensityGrid grid = cloud_grid(cloud, Transform());
    Rng rng(4);
    double error = 0, mean = 0;
    constexpr int kPlaces = 5000;
    for (int i = 0; i < kPlaces; ++i) {
        const Vec2 u = rng.next_2d();
        const Vec3 p{2 * u.x - 1, u.y, rng.next_float()};
        error += std::abs(double(grid.at(p) - cloud.at(p))) / kPlaces;
        mean += double(cloud.at(p)) / kPlaces;
    }
    EXPECT_GT(mean, 0.2);
    EXPECT_LT(error, 0.02);
    EXPECT_EQ(grid.at({0, 1.5f, 0}), 0);
    // Full below half of the height, as its formula has it
    EXPECT_NEAR(grid.at({0.3f, 0.0f, 0.4f}), 1, 1e-4);
}

}  // namespace
}  // namespace covtrace
