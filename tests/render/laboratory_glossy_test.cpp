// Rough mirrors and rough glass: the real radiance around the centre of a highlight against the
// replay.
#include "tests/render/laboratory_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

struct Case {
    const char* name;
    std::string text;
};

/// The scene: the camera looks from `from` at the origin, where the rough surface lies in the plane
/// z = 0.
std::string scene(const char* from, const char* camera, const std::string& light,
                  const std::string& surface) {
    return fmt::format(R"(
Integrator "path" "integer maxdepth" 1
Film "rgb" "integer xresolution" 32 "integer yresolution" 32
LookAt {}  0 0 0  0 1 0
Camera {}
WorldBegin
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 100 100 100 ]
{}
AttributeEnd
AttributeBegin
{}
AttributeEnd
)",
                       from, camera, light, surface);
}
std::string rough(const char* roughness, const char* shape = nullptr) {
    return fmt::format(
        "Material \"conductor\" \"rgb reflectance\" [ 0.9 0.9 0.9 ] \"bool remaproughness\" false "
        "{}\n{}",
        roughness,
        shape
            ? shape
            : R"(Shape "trianglemesh" "point3 P" [ -9 -9 0  9 -9 0  9 9 0  -9 9 0 ] "point2 uv" [ 0 0 1 0 1 1 0 1 ] "integer indices" [ 0 1 2 0 2 3 ])");
}
/// A disc at `place` that faces the origin, turned about y by `angle`.
std::string disc(const char* place, double angle, double radius) {
    return fmt::format("Translate {}\nRotate {} 0 1 0\nShape \"disk\" \"float radius\" {}", place,
                       angle, radius);
}

const char* kWide = R"("perspective" "float fov" 30)";
const char* kRough1 = R"("float roughness" 0.1)";
const char* kRough3 = R"("float roughness" 0.3)";

const Case kCases[]{
    {"rough mirror, alpha 0.1, at 30 degrees",
     scene("-2 0 3.4641", kWide, disc("2 0 3.4641", 210, 0.05), rough(kRough1))},
    {"rough mirror, alpha 0.3, at 30 degrees",
     scene("-2 0 3.4641", R"("perspective" "float fov" 60)", disc("2 0 3.4641", 210, 0.05),
           rough(kRough3))},
    {"rough mirror, alpha 0.1, at 57 degrees",
     scene("-3.355 0 2.179", kWide, disc("3.355 0 2.179", 237, 0.05), rough(kRough1))},
    {"rough mirror of a large light",
     scene("-2 0 3.4641", kWide, disc("2 0 3.4641", 210, 0.5), rough(kRough1))},
    {"anisotropic rough mirror, alpha 0.05 and 0.2, at 30 degrees",
     scene("-2 0 3.4641", kWide, disc("2 0 3.4641", 210, 0.05),
           rough(R"("float uroughness" 0.05 "float vroughness" 0.2)"))},
    {"rough convex mirror",
     scene("-2 0 3.4641", kWide, disc("2 0 3.4641", 210, 0.05),
           rough(kRough1, "Translate 0 0 -5\nShape \"sphere\" \"float radius\" 5"))},
    {"rough mirror of a moving light", scene("-2 0 3.4641", kWide,
                                             "ActiveTransform EndTime\nTranslate 0.5 0.8 "
                                             "0\nActiveTransform All\nTranslate -0.25 -0.4 0\n" +
                                                 disc("2 0 3.4641", 210, 0.05),
                                             rough(kRough1))},
    {"rough mirror out of focus",
     scene("-2 0 3.4641",
           R"("perspective" "float fov" 30 "float lensradius" 0.4 "float focaldistance" 2)",
           disc("2 0 3.4641", 210, 0.05), rough(kRough1))},
    {"rough glass",
     scene(
         "0 0 4", kWide, "Translate 0 0 -4\nShape \"disk\" \"float radius\" 0.05",
         R"(Material "dielectric" "float eta" 1.5 "bool remaproughness" false "float roughness" 0.15
Shape "trianglemesh" "point3 P" [ -9 -9 0  9 -9 0  9 9 0  -9 9 0 ] "integer indices" [ 0 1 2 0 2 3 ])")},
};

TEST(Laboratory, GlossyIsWithin15Percent) {
    WorstCase worst("glossy");
    const MeasureOptions options{.samples = 1u << 15};
    for (const Case& s : kCases) {
        SCOPED_TRACE(s.name);
        const Table table(s.text);
        const Ratios r =
            compare(table.predicted().sigma, measure(table.radiance(), options), options);
        worst.add(s.name, r);
        EXPECT_TRUE(r.within(1.15)) << r.text;
    }
}

}  // namespace
}  // namespace covtrace
