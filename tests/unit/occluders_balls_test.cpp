// Spheres as occluders: exact, in blocks, and as polygons only where they are deformed.
#include <gtest/gtest.h>

#include <atomic>
#include <vector>

#include "core/frame.h"
#include "geometry_fixtures.h"
#include "occluders/query.h"

namespace covtrace {
namespace {

using namespace test;

/// Width = distance / 2: edges alone, however far along the segment.
EdgeMeasure plain(float widest) {
    EdgeMeasure m;
    m.b = 0.25f;
    m.widest = widest;
    return m;
}

std::vector<OutlineEvent> outlines(const OccluderQuery& query, Vec3 begin, Vec3 end,
                                   const EdgeMeasure& measure, float time = 0) {
    const OutlineEvents found = query({begin, end, time, {}, {}}, measure, 1e-4f);
    return {found.events.begin(), found.events.begin() + static_cast<ptrdiff_t>(found.count)};
}

TEST(OccluderBalls, OccludeOthersAndNotThemselves) {
    const Geometry g{scene_of({shape(sphere(1), AnimatedTransform(Transform::scale(1, 1, 2)))})};
    const OccluderQuery query(g);
    for (float gap : {0.02f, 0.1f, 0.3f}) {
        const auto found = outlines(query, {1 + gap, 0.001f, 6}, {1 + gap, 0, -6}, plain(0.3f));
        ASSERT_FALSE(found.empty());
        float best = kInfinity;
        for (const OutlineEvent& e : found) best = std::min(best, e.distance);
        EXPECT_NEAR(best, gap, 0.005f);
    }
    // From a point of the ball along its surface.
    const OccluderQuery::Segment away{{5, 0, 0.5f}, {1, 0, 0}, 0, {}, {0, 0}};
    EXPECT_EQ(query(away, plain(0.3f), 1e-4f).count, 0u);
}

TEST(OccluderBalls, AreOutlinedByTheirTangents) {
    // One as it is, one placed; the same ball of radius 1.
    const Vec3 center{0.3f, -0.2f, 0.5f};
    const AnimatedTransform at(Transform::translate(center) * Transform::scale(2, 2, 2));
    SceneDescription placed = scene_of({});
    placed.objects.push_back({"o", {shape(sphere(0.5f))}});
    placed.instances.push_back(
        {0, AnimatedTransform(at.start() * Transform::rotate(30, {1, 2, 3})), {}});
    const Geometry one{scene_of({shape(sphere(0.5f), at)})}, other{placed};
    const OccluderQuery exact(one), instanced(other);
    Random random(5);
    int some = 0;
    for (int i = 0; i < 1000; ++i) {
        const Vec3 begin = random.in_box(4), end = random.in_box(4);
        const float length = distance(begin, end), d = distance(end, center);
        if (distance(begin, center) < 1.05f || d < 1.05f) continue;
        EdgeMeasure m;
        m.a1 = random.between(0, 0.2f);
        m.b = 1;
        m.h1 = -random.between(0, 1) / length;
        m.h2 = sqr(m.h1) / 4 + 0.01f;
        m.widest = 0.6f;
        // By brute force, around the circle where tangents from the end touch the ball.
        const Vec3 axis = (begin - end) / length;
        const Frame frame = Frame::from_z((center - end) / d);
        float narrowest = kInfinity;
        for (int j = 0; j < 2000; ++j) {
            const float a = 2 * kPi * static_cast<float>(j) / 2000, rho = std::sqrt(d * d - 1) / d;
            const Vec3 p =
                frame.z * (d - 1 / d) + (frame.x * std::cos(a) + frame.y * std::sin(a)) * rho;
            const float z = dot(p, axis);
            if (z < 1e-4f || z > length - 1e-4f) continue;
            narrowest = std::min(narrowest, m.width_squared(z, length_squared(p - axis * z)));
        }
        const auto found = outlines(exact, begin, end, m),
                   same = outlines(instanced, begin, end, m);
        ASSERT_EQ(found.size(), same.size());
        if (std::sqrt(narrowest) > 0.99f * m.widest) continue;
        ASSERT_FALSE(found.empty());
        ++some;
        float best = kInfinity, best_same = kInfinity;
        for (const OutlineEvent& e : found) best = std::min(best, e.width);
        for (const OutlineEvent& e : same) best_same = std::min(best_same, e.width);
        ASSERT_NEAR(best, std::sqrt(narrowest), 0.02f * best + 2e-3f);
        ASSERT_NEAR(best_same, best, 1e-3f * best + 1e-4f);
    }
    EXPECT_GT(some, 50);
}

TEST(OccluderBalls, TakeEdgesOnlyWhereTheyAreDeformed) {
    SceneDescription scene = scene_of({shape(sphere(0.5f)), shape(sphere(0.1f))});
    scene.objects.push_back({"o", {shape(sphere(0.5f))}});
    scene.instances.push_back({0, AnimatedTransform(Transform::translate({3, 0, 0})), {}});
    EXPECT_EQ(OccluderQuery(Geometry{scene}).edges(), 0u);

    scene.instances.push_back(
        {0, AnimatedTransform(Transform::translate({6, 0, 0}) * Transform::scale(1, 1, 2)), {}});
    const Geometry g{scene};
    const OccluderQuery query(g);
    EXPECT_GT(query.edges(), 0u);
    // Beside the ball and beside the ellipsoid of one object, whose tangents touch it in x.
    for (const float x : {3.0f, 6.0f}) {
        const auto found = outlines(query, {x + 0.6f, 0, 6}, {x + 0.6f, 0, -6}, plain(0.3f));
        ASSERT_FALSE(found.empty());
        float best = kInfinity;
        for (const OutlineEvent& e : found) best = std::min(best, e.distance);
        EXPECT_NEAR(best, 0.1f, 0.01f) << x;
    }
}

TEST(OccluderBalls, TheNarrowestOfMany) {
    // In blocks of eight, of which some are seen from inside and one is the segment's own.
    Random random(11);
    std::vector<ShapeDescription> balls;
    std::vector<Vec3> centers;
    for (int i = 0; i < 60; ++i) {
        centers.push_back(random.in_box(2));
        balls.push_back(
            shape(sphere(0.1f), AnimatedTransform(Transform::translate(centers.back()))));
    }
    const Geometry g{scene_of(balls)};
    const OccluderQuery query(g);
    int some = 0;
    for (int i = 0; i < 500; ++i) {
        const Vec3 begin = random.in_box(4), end = random.in_box(4);
        const uint32_t own = uint32_t(i) % 60;
        const Vec3 axis = normalize(begin - end);
        float narrowest = kInfinity;
        for (size_t k = 0; k < centers.size(); ++k) {
            const Vec3 to = centers[k] - end;
            const float d = length(to), z = dot(to, axis);
            if (k == own || d < 0.1f) continue;
            // The circle of tangents, by brute force.
            const Frame frame = Frame::from_z(to / d);
            const float rho = 0.1f * std::sqrt(d * d - 0.01f) / d;
            for (int j = 0; j < 400 && std::abs(z) < 10; ++j) {
                const float a = 2 * kPi * static_cast<float>(j) / 400;
                const Vec3 p = frame.z * (d - 0.01f / d) +
                               (frame.x * std::cos(a) + frame.y * std::sin(a)) * rho;
                const float at = dot(p, axis);
                if (at < 1e-3f || at > distance(begin, end) - 1e-3f) continue;
                narrowest = std::min(narrowest, length(p - axis * at));
            }
        }
        if (narrowest > 0.28f) continue;
        ++some;
        const OutlineEvents found = query({begin, end, 0, {}, {own, 0}}, plain(0.3f), 1e-4f);
        ASSERT_GT(found.count, 0u);
        float best = kInfinity;
        for (size_t k = 0; k < found.count; ++k) {
            best = std::min(best, found.events[k].distance);
            ASSERT_NEAR(dot(found.events[k].direction, axis), 0, 1e-4f);
        }
        ASSERT_NEAR(best, narrowest, 1e-3f);
    }
    EXPECT_GT(some, 100);
}

TEST(OccluderBalls, AreNoneOnceCancelled) {
    SceneDescription scene = scene_of({});
    scene.objects.push_back({"o", {shape(sphere(0.01f))}});
    Random random(3);
    for (int i = 0; i < 20000; ++i)
        scene.instances.push_back(
            {0, AnimatedTransform(Transform::translate(random.in_box(2))), {}});
    const Geometry g{scene};
    // As late as it may be asked; by more than the object's shape and each of its instances.
    std::atomic<int> asked = 0;
    const auto found = [&](int last) {
        asked = 0;
        const OccluderQuery query(g, [&] { return ++asked >= last; });
        return outlines(query, {0, 0, 5}, {0, 0, -5}, plain(0.3f)).size();
    };
    EXPECT_GT(found(1 << 20), 0u);
    const int all = asked;
    EXPECT_GT(all, 20);
    for (int last = 1; last <= all; ++last) EXPECT_EQ(found(last), 0u) << last;
}

}  // namespace
}  // namespace covtrace
