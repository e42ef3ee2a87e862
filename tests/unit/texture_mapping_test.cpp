#include "texture/mapping.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace covtrace {
namespace {

using Kind = TextureMapping::Kind;

TextureMapping mapping_of(Kind kind) {
    TextureMapping m;
    m.kind = kind;
    m.scale_u = 3;
    m.scale_v = -2;
    m.delta_u = 0.25f;
    m.delta_v = 0.5f;
    m.v1 = {0.5f, 0.25f, 0};
    m.v2 = {0, 1, -2};
    m.texture_from_world = Transform::rotate(35, {1, 2, -1}) * Transform::scale(2, 1, 0.5) *
                           Transform::translate({0.3f, -0.2f, 0.7f});
    return m;
}

TEST(TextureMapping, FollowsPbrtsDefinitions) {
    TextureMapping m;
    m.scale_u = 3;
    m.scale_v = 2;
    m.delta_u = 0.25f;
    m.delta_v = -1;
    EXPECT_EQ(map_to_st(m, {{0.5f, 0.25f}, {}}), (Vec2{1.75f, -0.5f}));
    m.kind = Kind::spherical;
    EXPECT_NEAR(map_to_st(m, {{}, {0, 0, 5}}).x, 0, 1e-6);
    EXPECT_NEAR(map_to_st(m, {{}, {2, 0, 0}}).x, 0.5, 1e-6);
    EXPECT_NEAR(map_to_st(m, {{}, {0, 2, 0}}).y, 0.25, 1e-6);
    EXPECT_NEAR(map_to_st(m, {{}, {0, -2, 0}}).y, 0.75, 1e-6);
    m.kind = Kind::cylindrical;
    EXPECT_NEAR(map_to_st(m, {{}, {2, 0, 7}}).x, 0.5, 1e-6);
    EXPECT_NEAR(map_to_st(m, {{}, {0, 2, 7}}).x, 0.75, 1e-6);
    EXPECT_NEAR(map_to_st(m, {{}, {2, 0, 7}}).y, 7, 1e-6);
    m.kind = Kind::planar;
    m.v1 = {0, 2, 0};
    m.v2 = {1, 0, 1};
    EXPECT_EQ(map_to_st(m, {{}, {1, 2, 3}}), (Vec2{4.25f, 3}));
}

RC_GTEST_PROP(TextureMapping, GradientAgreesWithFiniteDifferences, ()) {
    const auto kind = *rc::gen::element(Kind::uv, Kind::spherical, Kind::cylindrical, Kind::planar);
    const TextureMapping m = mapping_of(kind);
    const auto number =
        rc::gen::map(rc::gen::inRange(-1000, 1000), [](int i) { return float(i) / 500; });
    const Vec3 p{*number, *number, *number};
    const Vec3 dpdu{*number, *number, *number}, dpdv{*number, *number, *number};
    const Vec3 in_texture = m.texture_from_world.point(p);
    RC_PRE(in_texture.x * in_texture.x + in_texture.y * in_texture.y > 0.05f);

    const StGradient g = st_gradient(m, {{0.3f, 0.6f}, p}, dpdu, dpdv);
    const float h = 4e-3f;
    const auto at = [&](float u, float v) {
        return map_to_st(m, {{0.3f + u, 0.6f + v}, p + dpdu * u + dpdv * v});
    };
    const Vec2 by_u = (at(h, 0) - at(-h, 0)) * (0.5f / h),
               by_v = (at(0, h) - at(0, -h)) * (0.5f / h);
    // The azimuth jumps by a full turn somewhere.
    RC_PRE(std::abs(by_u.x) < 50 && std::abs(by_u.y) < 50 && std::abs(by_v.x) < 50 &&
           std::abs(by_v.y) < 50);
    RC_ASSERT(std::abs(by_u.x - g.s.x) < 0.01f + 0.01f * std::abs(g.s.x));
    RC_ASSERT(std::abs(by_v.x - g.s.y) < 0.01f + 0.01f * std::abs(g.s.y));
    RC_ASSERT(std::abs(by_u.y - g.t.x) < 0.01f + 0.01f * std::abs(g.t.x));
    RC_ASSERT(std::abs(by_v.y - g.t.y) < 0.01f + 0.01f * std::abs(g.t.y));
}

TEST(TextureMapping, IsFiniteAtPolesAndAxes) {
    for (const Kind kind : {Kind::spherical, Kind::cylindrical})
        for (const Vec3 p : {Vec3{0, 0, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}}) {
            TextureMapping m;
            m.kind = kind;
            const Vec2 st = map_to_st(m, {{}, p});
            EXPECT_TRUE(std::isfinite(st.x) && std::isfinite(st.y));
            const StGradient g = st_gradient(m, {{}, p}, {1, 0, 0}, {0, 1, 0});
            EXPECT_TRUE(std::isfinite(g.s.x + g.s.y + g.t.x + g.t.y));
        }
}

}  // namespace
}  // namespace covtrace
