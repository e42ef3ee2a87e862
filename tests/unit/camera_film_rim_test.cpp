/// The rim of a film's lit part, and the way to it.
#include "camera/film_rim.h"

#include <gtest/gtest.h>

#include <cmath>

namespace covtrace::test {
namespace {

constexpr int kWidth = 160, kHeight = 90;

CameraDescription fisheye() {
    CameraDescription d;
    d.kind = CameraDescription::Kind::spherical;
    d.mapping = CameraDescription::Mapping::equisolid;
    d.fov = 220;
    return d;
}

TEST(FilmRim, WayIsTheShortestOutOfTheCircle) {
    const Camera camera(fisheye(), kWidth, kHeight);  // a circle of radius 45 around (80, 45)
    const FilmRim rim(camera, {0, 0}, {kWidth, kHeight});
    ASSERT_TRUE(rim.is_there());
    for (const float inside : {1e-4f, 0.01f, 0.3f, 2.0f, 5.0f, 7.9f})
        for (int k = 0; k < 40; ++k) {
            const float turn = 0.157f * float(k);
            const Vec2 outward{std::cos(turn), std::sin(turn)};
            const auto way = rim.way(Vec2{80, 45} + outward * (45 - inside));
            ASSERT_TRUE(way) << inside << " " << k;
            EXPECT_NEAR(length(*way), inside, 0.02f + 0.02f * inside);
            EXPECT_GT(dot(*way, outward), 0.95f * length(*way)) << inside << " " << k;
        }
    for (const Vec2 film : {Vec2{80, 45}, Vec2{3, 3}, Vec2{80, 45 - 36.5f}})
        EXPECT_FALSE(rim.way(film));
}

TEST(FilmRim, IsThereWhereThePictureEnds) {
    const Camera camera(fisheye(), kWidth, kHeight);
    EXPECT_FALSE(FilmRim(camera, {60, 30}, {90, 60}).is_there());
    EXPECT_TRUE(FilmRim(camera, {35, 40}, {60, 50}).is_there());
    EXPECT_FALSE(FilmRim(Camera({}, kWidth, kHeight), {0, 0}, {kWidth, kHeight}).is_there());
}

}  // namespace
}  // namespace covtrace::test
