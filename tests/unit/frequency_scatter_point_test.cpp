// Recorded vertices as the operators of scattering see them.
#include "frequency/scatter_point.h"

#include <gtest/gtest.h>

#include "frequency/scene_spectra.h"
#include "turned_square.h"

namespace covtrace {
namespace {

using namespace test;
namespace cov = covariance;

/// The first vertex of a path that sees a place of the square along a fixed direction.
PathVertex vertex_at(const RenderScene& scene, Vec3 place, float angle) {
    PathRecord record;
    trace_path(scene, towards(place, angle), Sampler(1, 0, 0, 0), 5, &record);
    return record.vertices[0];
}

TEST(ScatterPoint, NormalsTurnAlongTheSurfaceAsTheFramesOfPathsDo) {
    const RenderScene scene = turned_square(kMetal);
    const SceneSpectra spectra(scene);
    const Vec3 place{0.1f, 0.2f, 0};
    for (const float angle : {1.4f, 0.3f}) {
        const PathVertex v = vertex_at(scene, place, angle);
        ASSERT_EQ(v.is_turned, angle > 1);
        const ScatterPoint point(scene, spectra.textures, v, 1e-3f);
        ASSERT_TRUE(point.normals);
        EXPECT_EQ(point.turned.has_value(), v.is_turned);
        EXPECT_NEAR(cov::dot(point.facing().n, cov::Vec3<double>(v.shading.z)), 1, 1e-6);
        constexpr float kStep = 0.02f;
        for (const Vec3 step : {Vec3{kStep, 0, 0}, Vec3{0, kStep, 0}}) {
            const Vec3 change = (vertex_at(scene, place + step, angle).shading.z -
                                 vertex_at(scene, place - step, angle).shading.z) /
                                (2 * kStep);
            const cov::Vec3<double> d{step / kStep};
            const cov::Vec3<double> predicted = cov::dot(d, point.surface.t1) * point.normals->d1 +
                                                cov::dot(d, point.surface.t2) * point.normals->d2;
            const cov::Vec3<double> error = predicted - cov::Vec3<double>(change);
            EXPECT_LT(std::sqrt(cov::dot(error, error)), 0.02) << angle;
        }
    }
}

}  // namespace
}  // namespace covtrace
