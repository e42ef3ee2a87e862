// A diffuse floor under a small emitter: the real radiance around a point, as the direction to the
// emitter goes from the zenith to 75 degrees, against the replay.
#include <array>

#include "tests/render/laboratory_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

/// The camera: orthographic, half a unit above the floor, looking straight down; a pixel is 1/8.
const char* kDown = R"(
Integrator "path" "integer maxdepth" 1
Film "rgb" "integer xresolution" 32 "integer yresolution" 32
LookAt 0 0 0.5  0 0 0  0 1 0
Camera "orthographic" "float screenwindow" [ -2 2 -2 2 ]
WorldBegin
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 100 100 100 ]
{}
AttributeEnd
Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]
Shape "trianglemesh" "point3 P" [ -90 -90 0  90 -90 0  90 90 0  -90 90 0 ] "integer indices" [ 0 1 2 0 2 3 ]
)";

std::string disc(double radius) {
    return fmt::format("Shape \"disk\" \"float radius\" {}", radius);
}
std::string above(double angle, double height, const std::string& shape) {
    // The disc's normal is +z, so it is turned over to shine down.
    return fmt::format("Translate {} 0 {}\nRotate 180 0 1 0\n{}",
                       height * std::tan(angle * kPiD / 180), height, shape);
}
std::string facing(double angle, double height, const std::string& shape) {
    return fmt::format("Translate {} 0 {}\nRotate {} 0 1 0\n{}",
                       height * std::tan(angle * kPiD / 180), height, 180 + angle, shape);
}
std::string sphere(double angle, double height, double radius) {
    return fmt::format("Translate {} 0 {}\nShape \"sphere\" \"float radius\" {}",
                       height * std::tan(angle * kPiD / 180), height, radius);
}

struct Light {
    const char* name;
    std::function<std::string(double angle)> at;
};
const Light kLights[]{
    {"small disc parallel to the floor", [](double a) { return above(a, 1, disc(0.1)); }},
    {"large disc parallel to the floor", [](double a) { return above(a, 1, disc(0.5)); }},
    {"small disc facing the point", [](double a) { return facing(a, 1, disc(0.1)); }},
    {"large disc facing the point", [](double a) { return facing(a, 1.2, disc(0.4)); }},
    {"small sphere", [](double a) { return sphere(a, 1, 0.1); }},
};

void expect_within(double first, double last, double bound, const char* name) {
    WorstCase worst(name);
    const MeasureOptions options{.samples = 1u << 15};
    for (const Light& light : kLights)
        for (double angle = first; angle <= last; angle += 15) {
            const std::string where = fmt::format("{} at {:.0f} degrees", light.name, angle);
            SCOPED_TRACE(where);
            const Table table(fmt::format(fmt::runtime(kDown), light.at(angle)));
            const Ratios r =
                compare(table.predicted(64).sigma, measure(table.radiance(), options), options);
            worst.add(where, r);
            EXPECT_TRUE(r.within(bound)) << r.text;
        }
}

TEST(Laboratory, DiffuseUpTo45DegreesIsWithin15Percent) {
    expect_within(0, 45, 1.15, "diffuse up to 45 degrees");
}

TEST(Laboratory, DiffuseUpTo75DegreesIsWithinAFactorOfOneAndAHalf) {
    expect_within(60, 75, 1.5, "diffuse from 60 to 75 degrees");
}

}  // namespace
}  // namespace covtrace
