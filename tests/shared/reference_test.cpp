// Our path tracer against pbrt-v4's converged images: the same scene must be as bright, channel by
// channel.
#include <gtest/gtest.h>

#include "image/compare.h"
#include "pbrt/read_scene.h"
#include "render/overrides.h"
#include "render/session.h"
#include "tests/shared/shared_folder.h"

namespace covtrace::test {
namespace {

struct Case {
    const char* name;
    double tolerance;  ///< tolerance of mean_ratio; spectral against RGB conductors differ more
};

class Reference : public testing::TestWithParam<Case> {};

TEST_P(Reference, MeansAgree) {
    const Case& c = GetParam();
    const Image reference =
        read_image(shared_folder() / "references" / (std::string(c.name) + ".exr"));
    SceneDescription description = read_pbrt(shared_folder() / "scenes" / c.name / "scene.pbrt");
    SceneOverrides overrides;
    overrides.resolution = {reference.width(), reference.height()};
    apply(overrides, description);
    RenderScene scene(std::move(description));
    RenderOptions options;
    options.method = Method::uniform;
    options.spp = 32;
    Monitor monitor;
    const Image image = render(scene, options, monitor).image;
    const Comparison difference = compare(image, reference);
    for (double ratio : difference.mean_ratio) EXPECT_NEAR(ratio, 1, c.tolerance);
    EXPECT_EQ(difference.nonfinite, 0);
    // The images show the same scene, not only the same brightness: compare the mean colours of 64
    // blocks
    constexpr int kBlocks = 8;
    for (int by = 0; by < kBlocks; ++by)
        for (int bx = 0; bx < kBlocks; ++bx) {
            const PixelBounds block{bx * image.width() / kBlocks, by * image.height() / kBlocks,
                                    (bx + 1) * image.width() / kBlocks,
                                    (by + 1) * image.height() / kBlocks};
            const Comparison local = compare(image, reference, block);
            EXPECT_NEAR(local.mean_ratio[1], 1, 0.25) << "block " << bx << ", " << by;
        }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Reference,
                         testing::Values(Case{"cornell-box", 0.03}, Case{"living-room", 0.03},
                                         Case{"staircase2", 0.03}, Case{"veach-mis", 0.03},
                                         Case{"material-testball", 0.05}),
                         [](const auto& scene) {
                             std::string name = scene.param.name;
                             std::erase(name, '-');
                             return name;
                         });

}  // namespace
}  // namespace covtrace::test
