// Edges: penumbrae behind an occluder, and borders out of focus or in motion. An edge has no second
// moment; its blur has, and the prediction is held against that: the deviation of the filter across
// the edge, after the integration over lens and shutter, against the deviation of the line spread
// function.
#include "tests/render/laboratory_fixtures.h"

namespace covtrace {
namespace {

using namespace test;

struct Case {
    const char* name;
    Vec2 across;   ///< direction across the edge, in pixels
    double reach;  ///< distance to the plateaus, pixels
    std::string text;
    std::string without{};  ///< text of the scene without the occluder; empty where there is none
};

std::string scene(const char* depth, const char* from, const char* camera,
                  const std::string& world) {
    return fmt::format(R"(
Integrator "path" "integer maxdepth" {}
Film "rgb" "integer xresolution" 32 "integer yresolution" 32
LookAt {}
Camera {}
WorldBegin
{}
)",
                       depth, from, camera, world);
}
/// A floor and a light `height` above it, with the occluder between them.
std::string lit_floor(const char* light, const std::string& occluder) {
    return fmt::format(R"(AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 50 50 50 ]
{}
AttributeEnd
Material "diffuse" "rgb reflectance" [ 0.5 0.5 0.5 ]
Shape "trianglemesh" "point3 P" [ -3 -3 0  3 -3 0  3 3 0  -3 3 0 ] "integer indices" [ 0 1 2 0 2 3 ]
Material "diffuse" "rgb reflectance" [ 0 0 0 ]
{})",
                       light, occluder);
}
const char* kDown = R"("orthographic" "float screenwindow" [ -1 1 -1 1 ])";
const char* kBelow = "0 0 0.4  0 0 0  0 1 0";
const char* kDisc = "Translate 0 0 4\nRotate 180 0 1 0\nShape \"disk\" \"float radius\" 0.5";
/// An occluder: half a plane x > edge at the height z.
std::string half_plane(double z, double edge) {
    return fmt::format(
        "Shape \"trianglemesh\" \"point3 P\" [ {1} -3 {0}  3 -3 {0}  3 3 {0}  {1} 3 {0} ] "
        "\"integer indices\" [ 0 1 2 0 2 3 ]",
        z, edge);
}

Case penumbra(const char* name, Vec2 across, double reach, const char* light,
              const std::string& occluder) {
    return {name, across, reach, scene("1", kBelow, kDown, lit_floor(light, occluder)),
            scene("1", kBelow, kDown, lit_floor(light, ""))};
}

const Case kPenumbrae[]{
    penumbra("penumbra of a half plane", {1, 0}, 14, kDisc, half_plane(1, 0)),
    penumbra("wider penumbra", {1, 0}, 30, kDisc, half_plane(2, 0)),
    penumbra("penumbra of a large square light", {1, 0}, 30,
             "Shape \"trianglemesh\" \"point3 P\" [ -1 -1 4  1 -1 4  1 1 4  -1 1 4 ] \"integer "
             "indices\" [ 0 2 1 0 3 2 ]",
             half_plane(1, 0)),
    penumbra("penumbra across the diagonal", {0.70710678f, 0.70710678f}, 14, kDisc,
             "Rotate 45 0 0 1\n" + half_plane(1, 0)),
    penumbra("penumbra near its bright end", {1, 0}, 16, kDisc, half_plane(1, 0.083)),
    penumbra("penumbra near its dark end", {1, 0}, 16, kDisc, half_plane(1, -0.083)),
    penumbra("penumbra of a ball", {1, 0}, 14, kDisc,
             "Translate 1 0 1\nShape \"sphere\" \"float radius\" 1"),
    penumbra("contact shadow", {1, 0}, 8, kDisc, half_plane(0.5, 0)),
};

/// A texture with one border in view, at x = edge; checks of 50 units.
std::string border(double edge, double tilt) {
    return fmt::format(R"(LightSource "infinite"
Texture "checks" "spectrum" "checkerboard" "float uscale" 0.02 "float vscale" 0.02 "float udelta" 0 "float vdelta" 0.5
    "rgb tex1" [ 0.9 0.9 0.9 ] "rgb tex2" [ 0.1 0.1 0.1 ]
Material "diffuse" "texture reflectance" "checks"
Translate {} 0 0
Rotate {} 1 0 0
Shape "trianglemesh" "point3 P" [ -40 -9 0  40 -9 0  40 9 0  -40 9 0 ]
    "point2 uv" [ -40 -9 40 -9 40 9 -40 9 ] "integer indices" [ 0 2 1 0 3 2 ])",
                       edge, tilt);
}
const char* kAhead = "0 0 -4  0 0 0  0 1 0";
const char* kLens =
    R"("perspective" "float fov" 20 "float lensradius" 0.3 "float focaldistance" 2.5)";

const Case kBorders[]{
    {"border out of focus", {1, 0}, 14, scene("1", kAhead, kLens, border(0, 0))},
    {"border out of focus, half a radius beside it",
     {1, 0},
     14,
     scene("1", kAhead, kLens, border(0.09, 0))},
    {"border in motion",
     {1, 0},
     14,
     scene("1", kAhead, R"("perspective" "float fov" 20)",
           "ActiveTransform EndTime\nTranslate 0.6 0 0\nActiveTransform All\nTranslate -0.3 0 0\n" +
               border(0, 0))},
    {"border out of focus and in motion",
     {1, 0},
     16,
     scene("1", kAhead, kLens,
           "ActiveTransform EndTime\nTranslate 0.4 0 0\nActiveTransform All\nTranslate -0.2 0 0\n" +
               border(0, 0))},
};

/// A shining ball that the middle ray touches `inside` within its rim.
std::string ball(double inside, const char* shape = "Shape \"sphere\" \"float radius\" 1") {
    return fmt::format("AreaLightSource \"diffuse\" \"rgb L\" [ 1 1 1 ]\nTranslate {} 0 0\n{}",
                       1 - inside, shape);
}
/// A ball as a mesh with normals.
std::string mesh_ball(int rings) {
    std::string points, normals, triangles;
    for (int i = 0; i <= rings; ++i)
        for (int j = 0; j <= 2 * rings; ++j) {
            const double theta = kPiD * i / rings, phi = kPiD * j / rings;
            const auto p = fmt::format("{} {} {} ", std::sin(theta) * std::cos(phi),
                                       std::cos(theta), std::sin(theta) * std::sin(phi));
            points += p;
            normals += p;
        }
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < 2 * rings; ++j) {
            const int a = i * (2 * rings + 1) + j, b = a + 2 * rings + 1;
            triangles += fmt::format("{} {} {} {} {} {} ", a, a + 1, b, a + 1, b + 1, b);
        }
    return fmt::format(
        "Shape \"trianglemesh\" \"point3 P\" [ {} ] \"normal N\" [ {} ] \"integer indices\" [ {} ]",
        points, normals, triangles);
}
const std::string kMeshBall = mesh_ball(32);

/// Cases without occluders: light ends at the ball's own outline.
const Case kRims[]{
    {"rim of a ball out of focus", {1, 0}, 14, scene("1", kAhead, kLens, ball(0))},
    {"rim of a ball out of focus, half a radius beside it",
     {1, 0},
     14,
     scene("1", kAhead, kLens, ball(0.09))},
    {"rim of a smooth mesh out of focus",
     {1, 0},
     14,
     scene("1", kAhead, kLens, ball(0.05, kMeshBall.c_str()))},
    {"rim of a ball in motion",
     {1, 0},
     14,
     scene("1", kAhead, R"("perspective" "float fov" 20)",
           "ActiveTransform EndTime\nTranslate 0.6 0 0\nActiveTransform All\nTranslate -0.3 0 0\n" +
               ball(0))},
    {"rim of a ball out of focus and in motion",
     {1, 0},
     16,
     scene("1", kAhead, kLens,
           "ActiveTransform EndTime\nTranslate 0.4 0 0\nActiveTransform All\nTranslate -0.2 0 0\n" +
               ball(0))},
};

/// Ratio of the deviation across the edge of the Gaussian whose spectrum is predicted to the
/// measured one.
double bandwidth_ratio(const Table& table, const Case& c) {
    const auto s = covariance::preintegrate(table.predicted_over_lens_and_shutter().sigma);
    const double d0 = c.across.x, d1 = c.across.y;
    const double variance = s.xx * d0 * d0 + 2 * s.xy * d0 * d1 + s.yy * d1 * d1;
    std::optional<Table> lit;
    LocalField without;
    if (!c.without.empty()) without = lit.emplace(c.without).radiance();
    const EdgeSpread e = edge_spread(table.radiance(), without, c.across, c.reach, 200 * 256, 3);
    return std::sqrt(variance) * 2 * kPiD * e.deviation;
}

void expect_within(std::span<const Case> cases, bool occlusion, const char* name) {
    WorstCase worst(name);
    for (const Case& c : cases) {
        SCOPED_TRACE(c.name);
        const Table table(c.text, occlusion);
        Ratios r;
        r.add("across", bandwidth_ratio(table, c));
        worst.add(c.name, r);
        EXPECT_GT(r.worst, 0.7);
        EXPECT_LT(r.worst, 1.3);
    }
}

TEST(Laboratory, PenumbraeAreWithin30Percent) {
    expect_within(kPenumbrae, true, "penumbrae");
}

TEST(Laboratory, BordersOutOfFocusAndInMotionAreWithin30Percent) {
    expect_within(kBorders, false, "blurred borders");
}

TEST(Laboratory, RimsOfCurvedShapesAreWithin30Percent) {
    expect_within(kRims, true, "own outlines");
}

}  // namespace
}  // namespace covtrace
