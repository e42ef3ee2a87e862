#include "occluders/outline_search.h"

#include <gtest/gtest.h>

#include <vector>

#include "geometry_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

struct Cloud {
    std::vector<Vec3> centers;
    std::vector<Bounds3> boxes;
};

constexpr float kRadius = 1e-3f;

/// A cloud of balls in the half space x > gap.
Cloud cloud(size_t count, float gap) {
    Random random(7);
    Cloud c;
    while (c.centers.size() < count) {
        const Vec3 p = random.in_box(1);
        if (p.x < gap) continue;
        const Vec3 r{kRadius, kRadius, kRadius};
        c.centers.push_back(p);
        c.boxes.push_back({p - r, p + r});
    }
    return c;
}

/// A search along z, with an edge's distance as its width.
OutlineSearch search_along_z(float widest) {
    EdgeMeasure m;
    m.b = 1;
    m.widest = widest;
    return OutlineSearch({0, 0, 1}, {0, 0, -1}, m, 1e-4f);
}

size_t visits(const Cloud& c, OutlineSearch& search) {
    const BoxHierarchy hierarchy(c.boxes);
    size_t count = 0;
    hierarchy.search(
        [&](const BoxHierarchy::Node& node, uint32_t) { return search.near_world(node); },
        [&] { return search.limit(); },
        [&](uint32_t item) {
            ++count;
            const OccluderBall ball{c.centers[hierarchy.item(item)[0]], kRadius, {}};
            search.meet_balls(BallBlock(std::span(&ball, 1)), 0, item);
        });
    return count;
}

TEST(OutlineSearch, LooksAtFewOfManyOutlinesThatAreNear) {
    for (const float gap : {-1.0f, 0.01f}) {  // all around the segment, and on one side of it
        const Cloud c = cloud(160000, gap);
        OutlineSearch search = search_along_z(0.5f);
        EXPECT_LT(visits(c, search), 64u) << gap;
        EXPECT_TRUE(search.has_found());
    }
}

TEST(OutlineSearch, FindsOneOfTheNearestOfMany) {
    const Cloud c = cloud(20000, -1);
    OutlineSearch search = search_along_z(0.5f);
    visits(c, search);
    OutlineEvents events;
    search.collect(events, [](uint32_t, Vec3) { return Vec3{}; });
    ASSERT_GT(events.count, 0u);
    float found = kInfinity;
    for (size_t i = 0; i < events.count; ++i) found = std::min(found, events.events[i].distance);
    const auto nearer = std::count_if(c.centers.begin(), c.centers.end(), [found](Vec3 p) {
        return std::hypot(p.x, p.y) < found - kRadius;
    });
    EXPECT_LT(nearer, 10);
}

}  // namespace
}  // namespace covtrace
