// Geometry alone: a textured object seen directly, in mirrors, through glass, in motion and out of
// focus. The texture is replaced by a Gaussian spot of the covariance that the replay starts from,
// seen by real rays through the real geometry and camera, so that prediction and measurement differ
// by the chain of operators alone.
#include "tests/render/laboratory_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

constexpr double kBound = 1.02;

struct Case {
    const char* name;
    int mirrors;
    std::string text;
};

const char* kFilm = R"(
Integrator "path" "integer maxdepth" 8
Film "rgb" "integer xresolution" 32 "integer yresolution" 32
)";
const char* kLit = R"(
WorldBegin
LightSource "infinite"
Texture "checks" "spectrum" "checkerboard" "float uscale" 2.5 "float vscale" 2 "float udelta" 0.5 "float vdelta" 0.5
    "rgb tex1" [ 0.9 0.9 0.9 ] "rgb tex2" [ 0.1 0.1 0.1 ]
)";
/// The texture's coordinates are lengths; a check is 0.4 by 0.5 and centred on the origin.
const char* kChecked = R"(Material "diffuse" "texture reflectance" "checks"
Shape "trianglemesh" "point3 P" [ -9 -9 0  9 -9 0  9 9 0  -9 9 0 ]
    "point2 uv" [ -9 -9 9 -9 9 9 -9 9 ] "integer indices" [ 0 2 1 0 3 2 ]
)";
const char* kMirror = R"(Material "conductor" "rgb reflectance" [ 0.99 0.99 0.99 ]
)";

std::string camera(const char* look_at, const char* parameters) {
    return fmt::format("{}\nLookAt {}\nCamera {}\n{}", kFilm, look_at, parameters, kLit);
}
std::string block(const std::string& text) {
    return "AttributeBegin\n" + text + "\nAttributeEnd\n";
}
std::string moving(const std::string& motion, const std::string& text) {
    return block("ActiveTransform EndTime\n" + motion + "\nActiveTransform All\n" + text);
}
std::string moving_camera(const char* motion, const char* look_at, const char* parameters) {
    return std::string(kFilm) + "ActiveTransform EndTime\n" + motion +
           "\nActiveTransform All\nLookAt " + look_at + "\nCamera " + parameters + kLit;
}

const char* kPinhole = R"("perspective" "float fov" 20)";
const char* kLens =
    R"("perspective" "float fov" 20 "float lensradius" 0.3 "float focaldistance" 3)";

const Case kCases[]{
    {"plane", 0, camera("0 0 -4  0 0 0  0 1 0", kPinhole) + kChecked},
    {"plane tilted by 60 degrees", 0,
     camera("0 0 -4  0 0 0  0.3 1 0", kPinhole) + "Rotate 60 0 1 0\n" + kChecked},
    {"flat mirror", 1,
     camera("0 0 -3  0 0 0  0 1 0", kPinhole) +
         block(std::string(kMirror) + "Rotate 45 0 1 0\nShape \"disk\" \"float radius\" 2") +
         "Translate -5 0 0\nRotate 90 0 1 0\n" + kChecked},
    {"convex mirror", 1,
     camera("0 0 -4  0.3 0.2 0  0 1 0", R"("perspective" "float fov" 6)") +
         block(std::string(kMirror) + "Translate 0 0 3\nShape \"sphere\" \"float radius\" 3") +
         "Translate 0 0 -6\nRotate 10 1 0 0\n" + kChecked},
    {"concave mirror", 1,
     camera("0 0 -2  0.3 0.2 0  0 1 0", R"("perspective" "float fov" 10)") +
         block(std::string(kMirror) + "Translate 0 0 -8\nShape \"sphere\" \"float radius\" 8 "
                                      "\"float zmin\" 7 \"float zmax\" 8") +
         "Translate 0 0 -3\nRotate 180 1 0 0\n" + kChecked},
    {"convex mirror at 60 degrees", 1,
     camera("-4 0 -2.3  0 0.1 0  0 1 0", R"("perspective" "float fov" 4)") +
         block(std::string(kMirror) + "Translate 0 0 5\nShape \"sphere\" \"float radius\" 5") +
         "Translate 4 0 -2.3\nRotate 100 0 1 0\n" + kChecked},
    {"slab of glass", 2,
     camera("1 0.5 -8  0 0 0  0 1 0", kPinhole) + block(R"(Material "dielectric" "float eta" 1.5
Shape "trianglemesh" "point3 P" [ -9 -9 -5  9 -9 -5  9 9 -5  -9 9 -5 ] "integer indices" [ 0 2 1 0 3 2 ]
Shape "trianglemesh" "point3 P" [ -9 -9 -2  9 -9 -2  9 9 -2  -9 9 -2 ] "integer indices" [ 0 1 2 0 2 3 ])") +
         kChecked},
    {"ball of glass", 2,
     camera("0 0 -4  0.15 0.1 0  0 1 0", R"("perspective" "float fov" 6)") +
         block("Material \"dielectric\" \"float eta\" 1.3\nShape \"sphere\" \"float radius\" 1") +
         "Translate 0 0 1.6\n" + kChecked},
    {"moving textured plane", 0,
     camera("0 0 -4  0 0 0  0 1 0", kPinhole) +
         moving("Translate 0.6 0.3 0.5", std::string("Rotate 30 0 1 0\n") + kChecked)},
    {"rotating textured plane", 0,
     camera("0 0 -4  1.6 0.8 0  0 1 0", kPinhole) + moving("Rotate 10 0 0 1", kChecked)},
    {"moving camera", 0,
     moving_camera("Translate 0.2 0 0.4\nRotate 4 0 1 0", "0 0 -4  0 0 0  0 1 0", kPinhole) +
         kChecked},
    {"plane out of focus", 0, camera("0 0 -4  0 0 0  0 1 0", kLens) + kChecked},
    {"tilted plane out of focus", 0,
     camera("0 0 -4  0 0 0  0 1 0", kLens) + "Rotate 40 1 1 0\n" + kChecked},
    {"orthographic camera with a lens", 0,
     camera(
         "0 0 -4  0 0 0  0 1 0",
         R"("orthographic" "float screenwindow" [-1 1 -1 1] "float lensradius" 0.3 "float focaldistance" 3)") +
         "Rotate 30 1 0 0\n" + kChecked},
    {"moving mirror", 1,
     camera("0 0 -3  0 0 0  0 1 0", kPinhole) +
         moving("Translate 0.1 0 0.1\nRotate 3 0 1 0",
                std::string(kMirror) + "Rotate 45 0 1 0\nShape \"disk\" \"float radius\" 2") +
         "Translate -5 0 0\nRotate 90 0 1 0\n" + kChecked},
    {"moving plane in a moving convex mirror by a moving lens", 1,
     moving_camera(
         "Translate 0.05 0.02 0", "0 0 -4  0.3 0.2 0  0 1 0",
         R"("perspective" "float fov" 6 "float lensradius" 0.1 "float focaldistance" 6)") +
         moving("Translate 0.02 0 0",
                std::string(kMirror) + "Translate 0 0 3\nShape \"sphere\" \"float radius\" 3") +
         moving("Translate 0.4 -0.3 0", std::string("Translate 0 0 -6\n") + kChecked)},
};

TEST(Laboratory, GeometryIsWithinTwoPercentPerAxis) {
    WorstCase worst("geometry");
    const MeasureOptions options{.samples = 1u << 15};
    for (const Case& s : kCases) {
        SCOPED_TRACE(s.name);
        const Table table(s.text);
        const auto probe = table.probe(s.mirrors);
        ASSERT_TRUE(probe) << "no path takes the way of the set-up";
        const Ratios r = compare(probe->predicted, measure(probe->field, options), options);
        worst.add(s.name, r);
        EXPECT_TRUE(r.within(kBound)) << r.text;
    }
}

}  // namespace
}  // namespace covtrace
