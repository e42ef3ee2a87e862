/// Reading succeeds or throws covtrace::Error, whatever the text.
#include <random>

#include "pbrt_test_support.h"

namespace covtrace::test {
namespace {

const std::string kScene = R"(
LookAt 3 4 1.5  .5 .5 0  0 0 1
Camera "perspective" "float fov" 45 "float lensradius" [ .1 ]
Sampler "halton" "integer pixelsamples" 8
Integrator "volpath" "integer maxdepth" [ 5 ]
PixelFilter "triangle" "float xradius" 1
Film "rgb" "string filename" "simple.png" "integer xresolution" [ 40 ] "integer yresolution" [ 30 ]
WorldBegin
LightSource "infinite" "rgb L" [ .4 .45 .5 ]
LightSource "spot" "blackbody I" 3000 "float scale" 1.5 "point3 from" [ 1 2 3 ]
Texture "checks" "spectrum" "checkerboard" "float uscale" [ 16 ] "rgb tex1" [ .1 .1 .1 ] "rgb tex2" [ .8 .8 .8 ]
MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_s" [ 0 0 0 ]
MakeNamedMaterial "metal" "string type" "conductor" "spectrum eta" "metal-Au-eta" "float roughness" .2
AttributeBegin
  Material "dielectric" "float eta" 1.5
  MediumInterface "fog" ""
  ActiveTransform EndTime Translate 0 0 .2 ActiveTransform All
  Shape "sphere" "float radius" 1
AttributeEnd
ObjectBegin "box"
  NamedMaterial "metal"
  Shape "loopsubdiv" "integer levels" 1 "point3 P" [ 1 1 1 -1 -1 1 -1 1 -1 1 -1 -1 ] "integer indices" [ 0 2 1 0 1 3 0 3 2 1 2 3 ]
ObjectEnd
ObjectInstance "box"
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [ 3 3 3 ] "bool twosided" true
  Material "diffuse" "texture reflectance" "checks"
  Translate 0 0 -1 Rotate 30 0 1 0 Scale 2 2 2
  Shape "bilinearmesh" "point3 P" [ -20 -20 0 20 -20 0 -20 20 0 20 20 0 ] "point2 uv" [ 0 0 1 0 1 1 0 1 ]
  ConcatTransform [ 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 ]
  Shape "curve" "point3 P" [ 0 0 0 1 0 0 1 1 0 2 1 1 ] "float width" .1
  Shape "trianglemesh" "point3 P" [ 0 0 0 1 0 0 0 1 0 ] "float alpha" .5
AttributeEnd
)";

TEST(SceneRobustness, TheSceneItselfIsFine) {
    const auto scene = read_pbrt_string(kScene, "t.pbrt");
    EXPECT_EQ(scene.shapes.size(), 4u);
    EXPECT_EQ(scene.objects.size(), 1u);
}

/// Whether the text was read; anything but covtrace::Error fails the test.
bool survives(const std::string& text) {
    try {
        read_pbrt_string(text, "t.pbrt", "/nonexistent");
        return true;
    } catch (const Error& e) {
        EXPECT_STRNE(e.what(), "");
        EXPECT_TRUE(e.kind() == ErrorKind::scene || e.kind() == ErrorKind::limit) << e.what();
        return false;
    }
}

TEST(SceneRobustness, TruncationAnywhere) {
    for (size_t n = 0; n < kScene.size(); ++n) survives(kScene.substr(0, n));
}

TEST(SceneRobustness, RandomMutations) {
    std::mt19937 random(20261121);
    const auto below = [&](size_t n) {
        return std::uniform_int_distribution<size_t>(0, n - 1)(random);
    };
    const std::string bytes =
        "\"[]#\n \\0123456789.-+eE\t\x00\x80\xff"
        "abzN";
    const char* const words[] = {" nan ",
                                 " 1e30 ",
                                 " -1 ",
                                 " 0 ",
                                 " 2147483647 ",
                                 " [ ",
                                 " ] ",
                                 " \"\" ",
                                 " true ",
                                 " Include \"x\" ",
                                 " \"float radius\" ",
                                 " AttributeEnd ",
                                 " WorldBegin ",
                                 " 1e-30 "};
    size_t read = 0;
    for (int round = 0; round < 20000; ++round) {
        std::string text = kScene;
        for (size_t changes = 1 + below(3); changes > 0; --changes) {
            const size_t at = below(text.size());
            switch (below(5)) {
                case 0:
                    text[at] = bytes[below(bytes.size())];
                    break;
                case 1:
                    text.insert(at, words[below(std::size(words))]);
                    break;
                case 2:
                    text.erase(at, 1 + below(20));
                    break;
                case 3:
                    text.insert(at, text.substr(below(text.size()), below(60)));
                    break;
                default:
                    text[at] = static_cast<char>(below(256));
                    break;
            }
        }
        read += survives(text);
    }
    // Mutations test nothing where all are refused, or none.
    EXPECT_GT(read, 400u);
    EXPECT_LT(read, 19000u);
}

TEST(SceneRobustness, SwappedTokens) {
    std::vector<std::string> tokens;
    for (size_t i = 0; i < kScene.size();) {
        const size_t start = kScene.find_first_not_of(" \n", i);
        if (start == std::string::npos) break;
        size_t end = kScene.find_first_of(" \n", start);
        if (kScene[start] == '"') end = kScene.find('"', start + 1) + 1;
        tokens.push_back(kScene.substr(start, end - start));
        i = end;
    }
    std::mt19937 random(7);
    for (int round = 0; round < 3000; ++round) {
        auto mixed = tokens;
        for (int k = 0; k < 2; ++k)
            std::swap(mixed[random() % mixed.size()], mixed[random() % mixed.size()]);
        std::string text;
        for (const std::string& t : mixed) text += t + " ";
        survives(text);
    }
}

TEST(SceneRobustness, DeepNesting) {
    std::string text = "WorldBegin\n";
    for (int i = 0; i < 2000; ++i) text += "AttributeBegin ";
    EXPECT_FALSE(survives(text));
    for (int i = 0; i < 2000; ++i) text += "AttributeEnd ";
    EXPECT_TRUE(survives(text));
}

}  // namespace
}  // namespace covtrace::test
