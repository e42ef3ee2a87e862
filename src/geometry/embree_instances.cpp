#include "geometry/embree_instances.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/embree_shapes.h"

namespace covtrace {

namespace {

constexpr unsigned kMostSteps = 128;          ///< Embree's limit is 129 keys
constexpr double kInterpolationError = 5e-6;  ///< of the extent, at the tested times

GeometryHandle new_instance(const EmbreeDevice& device, RTCScene scene) {
    GeometryHandle instance(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
    device.check();
    rtcSetGeometryInstancedScene(instance.get(), scene);
    rtcSetGeometryMask(instance.get(), kEveryMask);
    return instance;
}

/// A matrix as translation * rotation * upper triangular scale, which is what Embree interpolates
/// too.
RTCQuaternionDecomposition decompose(const Transform& map) {
    const AnimatedTransform::Decomposition key = AnimatedTransform::decompose(map);
    const auto number = [](double v) { return static_cast<float>(v); };
    RTCQuaternionDecomposition d;
    rtcInitQuaternionDecomposition(&d);
    rtcQuaternionDecompositionSetTranslation(&d, key.translation.x, key.translation.y,
                                             key.translation.z);
    const Quaternion& q = key.rotation;
    rtcQuaternionDecompositionSetQuaternion(&d, number(q.w), number(q.x), number(q.y), number(q.z));
    const auto& s = key.scale;
    rtcQuaternionDecompositionSetScale(&d, number(s[0][0]), number(s[1][1]), number(s[2][2]));
    rtcQuaternionDecompositionSetSkew(&d, number(s[0][1]), number(s[0][2]), number(s[1][2]));
    return d;
}

/// Largest distance between the corners of `box` as Embree and as `motion` place them, less what
/// rounding the coordinates to float costs; relative to the placed box's diagonal.
double interpolation_error(RTCGeometry instance, const RTCBounds& box, const Motion& motion,
                           const ShutterClock& clock, unsigned steps) {
    double worst = 0;
    constexpr unsigned kTestsPerStep = 4;
    const unsigned tests = steps * kTestsPerStep;
    for (unsigned i = 0; i <= tests; ++i) {
        const float time = clock.key_time(i, tests);
        const Affine exact = Affine::from_matrix(motion.at(time).matrix());
        const Affine used = instance_transform(instance, clock.parameter(time));
        const double diagonal = length(
            exact.vector({double(box.upper_x) - box.lower_x, double(box.upper_y) - box.lower_y,
                          double(box.upper_z) - box.lower_z}));
        for (int c = 0; c < 8; ++c) {
            const Vec3d corner{c & 1 ? box.upper_x : box.lower_x, c & 2 ? box.upper_y : box.lower_y,
                               c & 4 ? box.upper_z : box.lower_z};
            const double rounding =
                16 * kHalfUlp * (length(exact.absolute(abs(corner))) + length(exact.translation));
            const double off = length(exact.point(corner) - used.point(corner)) - rounding;
            worst = std::max(worst, off / std::max(diagonal, 1e-30));
        }
    }
    return worst;
}

}  // namespace

GeometryHandle new_still_instance(const EmbreeDevice& device, RTCScene scene,
                                  const Transform& map) {
    GeometryHandle instance = new_instance(device, scene);
    std::array<float, 12> rows;
    for (size_t i = 0; i < 12; ++i) rows[i] = static_cast<float>(map.matrix().m[i / 4][i % 4]);
    rtcSetGeometryTransform(instance.get(), 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, rows.data());
    rtcCommitGeometry(instance.get());
    device.check();
    return instance;
}

GeometryHandle new_moving_instance(const EmbreeDevice& device, RTCScene scene, const Motion& motion,
                                   const ShutterClock& clock) {
    GeometryHandle instance = new_instance(device, scene);
    RTCBounds box;
    rtcGetSceneBounds(scene, &box);
    for (unsigned steps = clock.segments();; steps *= 2) {
        rtcSetGeometryTimeStepCount(instance.get(), steps + 1);
        for (unsigned i = 0; i <= steps; ++i) {
            const RTCQuaternionDecomposition key = decompose(motion.at(clock.key_time(i, steps)));
            rtcSetGeometryTransformQuaternion(instance.get(), i, &key);
        }
        rtcCommitGeometry(instance.get());
        device.check();
        if (2 * steps > kMostSteps ||
            interpolation_error(instance.get(), box, motion, clock, steps) < kInterpolationError)
            return instance;
    }
}

Affine instance_transform(RTCGeometry instance, float parameter) {
    std::array<float, 12> rows;
    rtcGetGeometryTransform(instance, parameter, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, rows.data());
    Affine map;
    for (size_t i = 0; i < 3; ++i) map.row[i] = {rows[4 * i], rows[4 * i + 1], rows[4 * i + 2]};
    map.translation = {rows[3], rows[7], rows[11]};
    return map;
}

}  // namespace covtrace
