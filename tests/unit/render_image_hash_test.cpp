#include "render/image_hash.h"

#include <gtest/gtest.h>

#include <memory>

#include "pbrt_test_support.h"

namespace covtrace::test {
namespace {

SceneDescription textured(ImageTexture image) {
    SceneDescription scene;
    scene.textures.push_back({"t", true, std::move(image), {}});
    return scene;
}

TEST(ImageHash, FollowsWhatTheFilesHold) {
    const TemporaryFolder folder;
    ImageTexture image;
    image.file = folder.write("a.png", "one");
    const std::string before = image_hash(textured(image));
    EXPECT_EQ(image_hash(textured(image)), before);
    folder.write("a.png", "two");
    EXPECT_NE(image_hash(textured(image)), before);
}

TEST(ImageHash, LeavesOutWhatTheSceneHoldsItself) {
    ImageTexture image;
    image.file = "images[0]";  // a name for messages: there is no such file
    image.content = std::make_shared<const std::string>("one");
    EXPECT_EQ(image_hash(textured(image)), image_hash(SceneDescription{}));
}

}  // namespace
}  // namespace covtrace::test
