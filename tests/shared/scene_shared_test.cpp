/// Real scenes read without complaints.
#include "tests/shared/shared_folder.h"
#include "tests/unit/pbrt_test_support.h"

namespace covtrace::test {
namespace {

TEST(SceneShared, RealScenesReadWithoutWarnings) {
    struct Case {
        const char* name;
        size_t shapes;
        int width, depth;
    };
    for (const Case& c : {Case{"cornell-box", 8, 1024, 65}, Case{"living-room", 65, 1280, 65},
                          Case{"material-testball", 4, 1280, 65}, Case{"staircase2", 32, 1024, 65},
                          Case{"veach-mis", 9, 1280, 3}}) {
        const auto scene = read_pbrt(shared_folder() / "scenes" / c.name / "scene.pbrt");
        EXPECT_EQ(warnings_of(scene), "") << c.name;
        EXPECT_EQ(scene.shapes.size(), c.shapes) << c.name;
        EXPECT_EQ(scene.film.width, c.width) << c.name;
        EXPECT_EQ(scene.max_depth, c.depth) << c.name;
    }
}

}  // namespace
}  // namespace covtrace::test
