// The grid of occluders against plain searches, and travel past its outlines against closed forms.
#include <covariance/renderer.hpp>
#include <optional>

#include "support.h"

namespace support {
namespace {

using namespace covariance;

std::vector<Outline<double>> outlines(const OccluderGrid<double>& grid, const Vec3& from,
                                      const Vec3& to, double time = 0) {
    std::vector<Outline<double>> all;
    grid.for_each_outline(from, to, time, [&](const Outline<double>& o) { all.push_back(o); });
    return all;
}

std::optional<double> nearest(const std::vector<Outline<double>>& all) {
    std::optional<double> r;
    for (const auto& o : all) r = std::min(r.value_or(o.distance), o.distance);
    return r;
}

/// Spheres of any place and motion beside a segment have their nearest outline where geometry says,
/// as long as it is within a cell.
RC_GTEST_PROP(OccluderGrid, FindsSpheresThatMoveBesideASegment, ()) {
    OccluderGrid<double> grid(8);
    grid.add_sphere({-5, -5, -5}, 0.01);
    grid.add_sphere({5, 5, 5}, 0.01);
    const Vec3 velocity = draw_vec3(3), from = draw_vec3(4), d = draw_direction();
    const double radius = draw(0.2, 1), gap = draw(0.01, 0.9), time = draw(-0.5, 0.5);
    const Frame frame = draw_frame(d);
    // A cell is at least 10/8 wide.
    const Vec3 center = from + 2.0 * d + (radius + gap) * frame.x;
    grid.add_sphere(center - time * velocity, radius, velocity);
    grid.build(-0.5, 0.5);
    const auto found = nearest(outlines(grid, from, from + 4.0 * d, time));
    RC_ASSERT(found.has_value());
    RC_ASSERT(*found < gap + 1e-9);
    for (const auto& o : outlines(grid, from, from + 4.0 * d, time))
        if (std::abs(o.distance - gap) < 1e-9) {
            RC_ASSERT(std::abs(o.ahead - 2) < 1e-9);
            RC_ASSERT(dot(o.direction, frame.x) > 1 - 1e-9);
            RC_ASSERT(o.velocity == velocity);
        }
}

/// A tetrahedron of four triangles: of its six edges those are outlines whose faces both lie on one
/// side, which are the edges of the convex hull of its shadow.
RC_GTEST_PROP(OccluderGrid, EdgesBetweenFacesAreOutlinesWhereTheShadowEnds, ()) {
    std::array<Vec3, 4> p;
    for (Vec3& v : p) v = draw_vec3(1);
    OccluderGrid<double> grid(1);  // one cell: everything is looked at
    for (std::size_t k = 0; k < 4; ++k) grid.add_triangle(p[k], p[(k + 1) % 4], p[(k + 2) % 4]);
    grid.build();
    const Frame f = draw_frame(draw_direction());
    const Vec3 middle = 0.25 * (p[0] + p[1] + p[2] + p[3]);
    const Vec3 from = middle - 5.0 * f.z + draw(-2, 2) * f.x, to = from + 10.0 * f.z;
    // The distance to the hull's edges in the plane across the ray, by a plain search.
    std::optional<double> expected;
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i + 1; j < 4; ++j) {
            std::array<double, 2> sides{};
            std::size_t n = 0;
            for (std::size_t k = 0; k < 4; ++k)
                if (k != i && k != j) sides[n++] = dot(cross(p[j] - p[i], f.z), p[k] - p[i]);
            if (!(sides[0] * sides[1] > 0)) continue;
            const double ax = dot(p[i] - from, f.x), ay = dot(p[i] - from, f.y);
            const double bx = dot(p[j] - p[i], f.x), by = dot(p[j] - p[i], f.y);
            const double k = std::clamp(-(ax * bx + ay * by) / (bx * bx + by * by), 0.0, 1.0);
            const double r = std::hypot(ax + k * bx, ay + k * by);
            expected = std::min(expected.value_or(r), r);
        }
    const auto found = nearest(outlines(grid, from, to));
    if (!expected || *expected > 1) return;  // beyond the reach of the cell
    RC_ASSERT(found.has_value());
    RC_ASSERT(std::abs(*found - *expected) < 1e-9);
}

TEST(OccluderGrid, NoOutlineWithinAWall) {
    OccluderGrid<double> grid(4);
    grid.add_triangle({0, 0, 0}, {4, 0, 0}, {4, 4, 0});
    grid.add_triangle({0, 0, 0}, {4, 4, 0}, {0, 4, 0});
    grid.build();
    const auto all = outlines(grid, {2.1, 2, 3}, {2.1, 2, 0});  // ends beside the diagonal
    for (const auto& o : all) EXPECT_GT(o.distance, 1);
}

TEST(OccluderGrid, ACornerOfARoomEndsTheLightOfItsWalls) {
    OccluderGrid<double> grid(4);
    grid.add_triangle({0, 0, 0}, {4, 0, 0}, {0, 4, 0});  // a floor
    grid.add_triangle({0, 0, 0}, {4, 0, 0}, {0, 0, 8});  // and a wall, on the x axis
    grid.build();
    const auto leaving = nearest(outlines(grid, {1.5, 0.3, 0}, {1.5, 1.3, 2}));
    ASSERT_TRUE(leaving);
    EXPECT_LT(*leaving, 0.3);
    // Light that only passes the corner on its way does not end there.
    for (const auto& o : outlines(grid, {1.5, 0.3, 2}, {1.5, 0.3, 0}))
        EXPECT_GT(std::abs(o.direction.x) * o.distance, 0.3);
}

TEST(OccluderGrid, TheSphereThatLightLeavesEndsAtItsContour) {
    OccluderGrid<double> grid;
    grid.add_sphere({0, 0, 0}, 1);
    grid.build();
    const double angle = 1.2;
    const Vec3 n{std::sin(angle), 0, std::cos(angle)};
    const auto leaving = outlines(grid, n, n + Vec3{0, 0, 2});
    ASSERT_FALSE(leaving.empty());
    const auto of_surface = contour<double>(
        Surface{n, {std::cos(angle), 0, -std::sin(angle)}, {0, 1, 0}, {1, 0, 1}}, Vec3{0, 0, 1});
    ASSERT_TRUE(of_surface);
    EXPECT_NEAR(leaving[0].distance, of_surface->distance, 1e-12);
    EXPECT_NEAR(dot(leaving[0].direction, of_surface->direction), 1, 1e-12);
    EXPECT_NEAR(leaving[0].ahead, of_surface->offset.z, 1e-12);
    // Light that arrives at the sphere, and light within, has no outline.
    EXPECT_TRUE(outlines(grid, n + Vec3{0, 0, 2}, n).empty());
    EXPECT_TRUE(outlines(grid, n, -1.0 * n).empty());
}

TEST(OccluderGrid, ShapesThatAreNotFiniteAreLeftOut) {
    OccluderGrid<double> grid, alone;
    for (OccluderGrid<double>* g : {&grid, &alone}) {
        g->add_sphere({0, 0, 0}, 1);
        g->add_triangle({2, 0, 0}, {3, 0, 0}, {2, 1, 0});
    }
    const double infinity = std::numeric_limits<double>::infinity();
    for (const double bad : {std::nan(""), infinity, -infinity, 1e300, 1e160}) {
        grid.add_triangle({bad, 0, 0}, {1, 0, 0}, {0, 1, 0});
        grid.add_triangle({0, 0, 0}, {1, bad, 0}, {0, 1, 0});
        grid.add_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, bad});
        grid.add_sphere({bad, 0, 0}, 1);
        grid.add_sphere({0, 0, 0}, bad);
        grid.add_sphere({0, 0, 0}, 1, {0, bad, 0});
        grid.add_huge_sphere({0, 0, bad}, 1);
        grid.add_huge_sphere({0, 0, 0}, bad);
    }
    grid.build();
    alone.build();
    EXPECT_EQ(grid.smallest(), alone.smallest());
    const auto found = outlines(grid, {1.02, 0, -2}, {1.02, 0, 2}),
               expected = outlines(alone, {1.02, 0, -2}, {1.02, 0, 2});
    ASSERT_FALSE(expected.empty());
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i)
        EXPECT_EQ(found[i].distance, expected[i].distance);
    // Times that are not finite find nothing, and neither do shapes that move out of all numbers.
    OccluderGrid<double> moving;
    moving.add_sphere({0, 0, 0}, 1, {1e150, 0, 0});
    for (const double bad : {std::nan(""), infinity, 1e300}) {
        moving.build(-bad, bad);
        EXPECT_TRUE(outlines(moving, {1.02, 0, -2}, {1.02, 0, 2}, bad).empty());
    }
}

TEST(OccluderGrid, LightFromInfinityEntersAtTheScenesBorder) {
    OccluderGrid<double> grid;
    EXPECT_EQ(grid.entry({1, 2, 3}, {0, 0, 1}), (Vec3{1, 2, 3}));
    grid.add_sphere({0, 0, 0}, 2);
    grid.build();
    EXPECT_EQ(grid.entry({0, 0, 0}, {0, 0, 1}), (Vec3{0, 0, 2}));
    EXPECT_EQ(grid.entry({0, 0, 5}, {0, 0, 1}), (Vec3{0, 0, 5}));
    const Field sky = distant_source(frame_along<double>(Vec3{0, 0, -1}), {});
    // Beside the sphere the sky has its edge; without shapes it has none.
    const Field beside = arrive_from_infinity(grid, sky, Vec3{2.1, 0, -2});
    EXPECT_GT(trace(beside.sigma.spatial()), 0);
    OccluderGrid<double> empty;
    empty.build();
    EXPECT_EQ(arrive_from_infinity(empty, sky, Vec3{2.1, 0, -2}), sky);
}

TEST(OccluderGrid, AHugeGroundHasItsHorizon) {
    OccluderGrid<double> grid;
    grid.add_sphere({0, 1, 0}, 1);
    grid.add_huge_sphere({0, -1000, 0}, 1000);
    grid.build();
    EXPECT_LT(grid.smallest(), 1e-3);  // of the small scene
    // A ray to the sky from 2 above the ground, at the angle a above the horizon's.
    const Vec3 eye{0, 2, 10};
    const double a = 0.01, horizon = std::acos(1000 / length(eye - Vec3{0, -1000, 0}));
    const Vec3 up = normalize(eye - Vec3{0, -1000, 0});
    const Vec3 level = normalize(cross(Vec3{1, 0, 0}, up));
    const Vec3 w = std::cos(a - horizon) * level + std::sin(a - horizon) * up;
    const auto found = nearest(outlines(grid, grid.entry(eye, w), eye));
    ASSERT_TRUE(found);
    const double expected = length(eye - Vec3{0, -1000, 0}) * std::cos(a - horizon) - 1000;
    EXPECT_NEAR(*found, expected, 1e-6);
    EXPECT_GT(expected, 0);
}

/// The penumbra of a lamp of deviation s behind an edge that the ray grazes, for a receiver that
/// sees all directions alike: 1/(4 pi^2 p^2), p^2 = (s z/(D - z))^2 + (beta r D/(D - z))^2.
TEST(TravelPast, GivesThePenumbraItsWidth) {
    const double s = 0.1, whole = 3, z = 1;
    OccluderGrid<double> grid(2);
    grid.add_triangle({1e-7, -50, z}, {1e-7, 50, z}, {50, 0, z});
    grid.build();
    Field f = area_source(Sym2::diagonal(s * s, s * s), frame_along<double>(Vec3{0, 0, -1}));
    f = travel_past(grid, f, Vec3{0, 0, whole}, Vec3{0, 0, 0});
    const double x2 = dot(f.frame.x, Vec3{1, 0, 0}) * dot(f.frame.x, Vec3{1, 0, 0});
    const Matrix lit = slice_angular(f.sigma);
    const double across = x2 > 0.5 ? lit(0, 0) : lit(1, 1);
    const double penumbra = s * z / (whole - z),
                 near = edge_beta<double> * grid.smallest(z) * whole / (whole - z);
    EXPECT_LT(near, 0.1 * penumbra);
    const double expected = 1 / (four_pi_sq<double> * (penumbra * penumbra + near * near));
    EXPECT_NEAR(across / expected, 1, 1e-9);
}

/// A small thing far away, as a moon, changes nothing of what stands beside the ray. The extent of
/// a point was a share of the whole scene's, five units in this one.
TEST(TravelPast, KnowsNearOutlinesInALargeScene) {
    const auto beside_a_ball = [](double far) {
        OccluderGrid<double> grid;
        grid.add_sphere({0, 0, 0}, 1);
        grid.add_sphere({far, 0, 0}, 1);
        grid.build();
        const Field sky = distant_source(frame_along<double>(Vec3{0, 0, 1}), {});
        return trace(arrive_from_infinity(grid, sky, Vec3{0, 1.05, 5}).sigma.spatial());
    };
    const double expected = beside_a_ball(10);
    EXPECT_GT(expected, 0);
    for (const double far : {1e3, 1e4, 1e5}) EXPECT_NEAR(beside_a_ball(far) / expected, 1, 1e-6);
}

TEST(TravelPast, IsTravelWhereNothingIsNear) {
    OccluderGrid<double> grid;
    grid.add_sphere({10, 0, 0}, 1);
    grid.build();
    const Field f = area_source(disc_moments(0.2), frame_along<double>(Vec3{0, 0, -1}));
    EXPECT_EQ(travel_past(grid, f, Vec3{0, 0, 5}, Vec3{}), travel(f, 5));
    EXPECT_EQ(travel_past(grid, f, Vec3{0, 0, 5}, Vec3{}, ThinLens<double>{}), travel(f, 5));
}

TEST(TravelPast, AnEdgeThatMovesIsBlurredByTheShutter) {
    OccluderGrid<double> grid(2);
    grid.add_sphere({1.2, 0, 1}, 1, {4, 0, 0});
    grid.build(-0.1, 0.1);
    Field f{{}, frame_along<double>(Vec3{0, 0, -1})};
    f = travel_past(grid, f, Vec3{0, 0, 2}, Vec3{}, mirror_receiver<double>);
    EXPECT_NEAR(f.sigma(4, 4) / trace(f.sigma.spatial()), 16, 1e-9);
    EXPECT_NEAR(trace(f.sigma.spatial()), edge_variance(0.2), 1e-9);
}

}  // namespace
}  // namespace support
