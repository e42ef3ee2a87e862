// Paths at places whose shading normal mirrors them to below the surface.
#include <gtest/gtest.h>

#include "turned_square.h"

namespace covtrace {
namespace {

using namespace test;

constexpr float kGrazing = 1.4f, kSteep = 0.3f;

/// Mean radiance of paths to the middle of the square.
float seen(const RenderScene& scene, float angle, int paths = 256) {
    double sum = 0;
    for (int i = 0; i < paths; ++i)
        sum += trace_path(scene, towards({0.1f, 0.2f, 0}, angle), Sampler(1, i, 0, 0), 5, nullptr)
                   .radiance.g;
    return float(sum / paths);
}

TEST(TurnedNormal, MetalsAndCoatsMirrorTheSkyAtGrazingAngles) {
    EXPECT_GT(seen(turned_square(kMetal), kGrazing), 0.8f);
    const char* rough = R"("conductor" "rgb reflectance" [ 0.8 0.8 0.8 ] "float roughness" 0.1
        "bool remaproughness" false)";
    EXPECT_GT(seen(turned_square(rough), kGrazing), 0.5f);
    // Fresnel's reflectance of index 1.5 at 1.48 radian, at which the turned normal is seen
    constexpr float kReflectance = 0.60f;
    const char* coated = R"("coateddiffuse" "rgb reflectance" [ 0 0 0 ] "float roughness" 0)";
    EXPECT_NEAR(seen(turned_square(coated), kGrazing, 4096), kReflectance, 0.04f);
    const char* coat = R"("diffuse" "rgb reflectance" [ 0 0 0 ] "float coat" 1)";
    EXPECT_NEAR(seen(turned_square(coat), kGrazing, 4096), kReflectance, 0.04f);
}

TEST(TurnedNormal, IsRecordedWhileFeaturesKeepTheSmoothOne) {
    const RenderScene scene = turned_square(kMetal);
    for (const float angle : {kGrazing, kSteep}) {
        PathRecord record;
        const Ray ray = towards({0.1f, 0.2f, 0}, angle);
        const PathResult path = trace_path(scene, ray, Sampler(1, 0, 0, 0), 5, &record);
        const PathVertex& v = record.vertices[0];
        EXPECT_EQ(v.is_turned, angle == kGrazing);
        EXPECT_EQ(path.normal, face_forward(v.hit.ns, v.wo));
        EXPECT_EQ(v.shading.z == v.hit.ns, !v.is_turned);
        // The frame is the one that the path was mirrored by
        const Vec3 mirrored = v.shading.z * (2 * dot(v.shading.z, v.wo)) - v.wo;
        EXPECT_NEAR(distance(mirrored, v.next_event.wi), 0, 1e-5f);
        if (v.is_turned) EXPECT_NEAR(v.next_event.wi.z, 0.01f, 1e-5f);
    }
}

TEST(TurnedNormal, DiffuseSurfacesAndGlassKeepTheirNormals) {
    for (const char* material : {"\"diffuse\"", "\"dielectric\"", "\"thindielectric\""}) {
        const RenderScene scene = turned_square(material);
        PathRecord record;
        trace_path(scene, towards({0.1f, 0.2f, 0}, kGrazing), Sampler(1, 0, 0, 0), 5, &record);
        EXPECT_FALSE(record.vertices[0].is_turned) << material;
        EXPECT_EQ(record.vertices[0].shading.z, record.vertices[0].hit.ns) << material;
    }
}

}  // namespace
}  // namespace covtrace
