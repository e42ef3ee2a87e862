// Bump and normal maps against closed forms.
#include "shading/normal_map.h"

#include <gtest/gtest.h>

#include "light_fixtures.h"

namespace covtrace::test {
namespace {

/// The unit square in z = 0, outside towards +z, u along x and v along y.
TriangleMesh unit_square() {
    TriangleMesh m;
    m.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    m.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    m.triangles = {{0, 1, 2}, {0, 2, 3}};
    return m;
}

/// The square, a material with the image as its map, and a hit on it.
struct Mapped {
    SceneDescription description;
    std::unique_ptr<Geometry> geometry;
    std::unique_ptr<TextureStore> textures;
    MaterialDescription material;
    SurfaceHit hit;
    DifferentialGeometry base;

    Mapped(const TemporaryImage& image, bool is_bump, float scale, Vec3 at,
           ShapeDescription shape = mesh_of(unit_square())) {
        ImageTexture t;
        t.file = image.path();
        t.scale = scale;
        t.wrap = ImageTexture::Wrap::clamp;
        TextureDescription d;
        d.is_spectrum = !is_bump;
        d.value = t;
        description.textures = {d};
        description.shapes = {std::move(shape)};
        geometry = std::make_unique<Geometry>(description);
        textures = std::make_unique<TextureStore>(description);
        (is_bump ? material.displacement : material.normal_map) = 0;
        EXPECT_TRUE(geometry->intersect({at + Vec3{0, 0, 5}, {0, 0, -1}}, hit));
        base = geometry->differential(hit);
    }
    NormalMap map(float footprint = 1e-3f) const {
        return {material, *textures, geometry->shapes()[0], hit, base, footprint};
    }
};

/// Texels whose height, between the centres of the four (u, v in 1/4 .. 3/4), is scale * s * t with
/// s = 2 u - 1/2 and t = 2 v - 1/2.
std::vector<Rgb> saddle() {
    // The upper row is at v = 3/4.
    return {Rgb(0), Rgb(1), Rgb(0), Rgb(0)};
}

void expect_near(Vec3 a, Vec3 b, float tolerance) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "axis " << i;
}

TEST(NormalMap, BumpIsTheNormalOfTheDisplacedSurface) {
    const TemporaryImage image(saddle(), 2, 2);
    constexpr float kScale = 0.3f, u = 0.6f, v = 0.4f;
    const Mapped m(image, true, kScale, {u, v, 0});
    const Frame frame = m.map().frame();
    const float du = kScale * 2 * (2 * v - 0.5f), dv = kScale * 2 * (2 * u - 0.5f);
    expect_near(frame.z, normalize(Vec3{-du, -dv, 1}), 2e-3f);
    expect_near(frame.x, normalize(Vec3{1, 0, du}), 2e-3f);
}

TEST(NormalMap, StrengthMixesTheBumpedNormalWithTheSurfacesOwn) {
    const TemporaryImage image(saddle(), 2, 2);
    constexpr float kScale = 30, u = 0.6f, v = 0.4f;  // steep: nearly along the surface
    const float du = kScale * 2 * (2 * v - 0.5f), dv = kScale * 2 * (2 * u - 0.5f);
    const Vec3 bumped = normalize(Vec3{-du, -dv, 1});
    Mapped m(image, true, kScale, {u, v, 0});
    for (const float strength : {0.0f, 0.2f, 1.5f}) {
        m.material.bump_strength = strength;
        Vec3 expected = normalize(bumped * strength + Vec3{0, 0, 1} * (1 - strength));
        if (expected.z < 0) expected = -expected;
        expect_near(m.map().frame().z, expected, 2e-3f);
    }
    // The surface is turned over: heights rise on its other side.
    ShapeDescription reversed = mesh_of(unit_square());
    reversed.reverse_orientation = true;
    Mapped r(image, true, kScale, {u, v, 0}, reversed);
    r.material.bump_strength = 0.2f;
    expect_near(r.map().frame().z,
                normalize(normalize(Vec3{-du, -dv, -1}) * 0.2f + Vec3{0, 0, -0.8f}), 2e-3f);
}

TEST(NormalMap, BumpAddsItsSecondDerivativesToTheCurvature) {
    const TemporaryImage image(saddle(), 2, 2);
    constexpr float kScale = 1e-3f;
    const Mapped m(image, true, kScale, {0.5f, 0.45f, 0});
    const auto [k11, k12, k22] = m.map(1e-2f).curvature();
    // The normal turns by d ns = -(d2 h / du dv) dq; the tangent frame is (x, y) up to its sign.
    const float sign = m.base.tangent.x.x * m.base.tangent.y.y;
    EXPECT_NEAR(k12, -4 * kScale * sign, 0.02f * 4 * kScale);
    EXPECT_NEAR(k11, 0, 0.05f * 4 * kScale);
    EXPECT_NEAR(k22, 0, 0.05f * 4 * kScale);
}

TEST(NormalMap, ConstantHeightOnASphereChangesNothing) {
    const TemporaryImage image({Rgb(1)}, 1, 1);
    const Mapped m(image, true, 0.2f, {0.3f, 0.4f, 0}, shape_of(whole_sphere(1)));
    expect_near(m.map().frame().z, m.hit.ns, 1e-4f);
}

TEST(NormalMap, ConstantHeightOnAPatchWithNormalsChangesNothing) {
    const TemporaryImage image({Rgb(1)}, 1, 1);
    BilinearMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    mesh.normals = {{-0.5f, -0.5f, 1}, {0.5f, -0.5f, 1}, {-0.5f, 0.5f, 1}, {0.5f, 0.5f, 1}};
    mesh.patches = {{0, 1, 2, 3}};
    const Mapped m(image, true, 0, {0.8f, 0.3f, 0},
                   shape_of(std::make_shared<const BilinearMesh>(std::move(mesh))));
    EXPECT_GT(m.hit.ns.x, 0.1f);
    expect_near(m.map().frame().z, m.hit.ns, 1e-5f);
}

TEST(NormalMap, ImagesHoldNormalsInTheFrameOfTheSurface) {
    const TemporaryImage image({Rgb(0.8f, 0.5f, 0.9f)}, 1, 1);
    const Mapped m(image, false, 1, {0.5f, 0.5f, 0});
    expect_near(m.map().frame().z, {0.6f, 0, 0.8f}, 1e-3f);
    // The surface is turned over: the normal is on the other side, dp/du stays.
    ShapeDescription reversed = mesh_of(unit_square());
    reversed.reverse_orientation = true;
    const Mapped r(image, false, 1, {0.5f, 0.5f, 0}, reversed);
    expect_near(r.map().frame().z, {0.6f, 0, -0.8f}, 1e-3f);
}

TEST(NormalMap, TangentsOfAMeshHoldInPlaceOfTheParameters) {
    // The map's x points along the mesh's own tangent, which is turned against u and not of unit
    // length.
    const TemporaryImage normals({Rgb(0.8f, 0.5f, 0.9f)}, 1, 1);
    TriangleMesh mesh = unit_square();
    mesh.tangents.assign(4, {0, 2, 0});
    expect_near(Mapped(normals, false, 1, {0.5f, 0.5f, 0}, mesh_of(mesh)).map().frame().z,
                {0, 0.6f, 0.8f}, 1e-3f);
    // The height is taken along u and v, but raises the tangents: S and n x S, both as long as S.
    const TemporaryImage heights(saddle(), 2, 2);
    constexpr float kScale = 0.3f, u = 0.6f, v = 0.4f;
    const Mapped m(heights, true, kScale, {u, v, 0}, mesh_of(mesh));
    const float du = kScale * 2 * (2 * v - 0.5f), dv = kScale * 2 * (2 * u - 0.5f);
    expect_near(m.map().frame().z, normalize(cross(Vec3{0, 2, du}, Vec3{-2, 0, dv})), 2e-3f);
}

TEST(NormalMap, MapsFollowStretchedAndMirroredCoordinates) {
    TriangleMesh mesh = unit_square();
    mesh.normals.assign(4, {0, 0, 1});
    for (Vec2& uv : mesh.uvs) uv.y = 0.75f - 0.5f * uv.y;
    const TemporaryImage heights(saddle(), 2, 2);
    constexpr float kScale = 0.3f, x = 0.6f, y = 0.4f;
    Mapped m(heights, true, kScale, {x, y, 0}, mesh_of(mesh));
    const float dx = kScale * 2 * (2 * (0.75f - 0.5f * y) - 0.5f), dy = -kScale * (2 * x - 0.5f);
    // In pbrt v is as long as u and left of it.
    expect_near(m.map().frame().z, normalize(Vec3{-dx, 2 * dy, 1}), 2e-3f);
    m.material.maps_follow_uv = true;
    expect_near(m.map().frame().z, normalize(Vec3{-dx, -dy, 1}), 2e-3f);

    const TemporaryImage normals({Rgb(0.5f, 0.8f, 0.9f)}, 1, 1);
    Mapped n(normals, false, 1, {x, y, 0}, mesh_of(mesh));
    expect_near(n.map().frame().z, {0, 0.6f, 0.8f}, 1e-3f);
    n.material.maps_follow_uv = true;
    expect_near(n.map().frame().z, {0, -0.6f, 0.8f}, 1e-3f);
}

TEST(NormalMap, NormalsThatLieBelowTheSurfaceAreTurned) {
    const TemporaryImage image({Rgb(0.9f, 0.5f, 0.2f)}, 1, 1);
    const Mapped m(image, false, 1, {0.5f, 0.5f, 0});
    EXPECT_GT(dot(m.map().frame().z, m.hit.ng), 0);
}

}  // namespace
}  // namespace covtrace::test
