#include "geometry/embree_instances.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/decomposition.h"
#include "geometry/embree_shapes.h"

namespace covtrace {

namespace {

constexpr unsigned kMostSteps = 128;          ///< Embree's limit is 129 keys
constexpr double kInterpolationError = 5e-6;  ///< part of the extent, at the tested times
/// Most steps, in each segment of the clock, that are tried with decompositions before straight
/// lines are. Embree bounds what turns by searching for extremes between any two keys, in 0.1 ms
/// per key and instance; straight lines cost it nothing, but are off by the square of the angle
/// between keys.
constexpr unsigned kFewSteps = 8;
GeometryHandle new_instance(const EmbreeDevice& device, RTCScene scene) {
    GeometryHandle instance(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
    device.check();
    rtcSetGeometryInstancedScene(instance.get(), scene);
    rtcSetGeometryMask(instance.get(), kEveryMask);
    return instance;
}

/// The key that Embree interpolates for a pose. Between two poses Embree does not always go the way
/// of AnimatedTransform, whose stretch is symmetric.
RTCQuaternionDecomposition decompose(const Transform& map) {
    const Decomposition key = triangular_decomposition(map.matrix());
    const auto number = [](double v) { return static_cast<float>(v); };
    RTCQuaternionDecomposition d;
    rtcInitQuaternionDecomposition(&d);
    rtcQuaternionDecompositionSetTranslation(&d, key.translation.x, key.translation.y,
                                             key.translation.z);
    const Quaternion& q = key.rotation;
    rtcQuaternionDecompositionSetQuaternion(&d, number(q.w), number(q.x), number(q.y), number(q.z));
    const auto& s = key.stretch;
    rtcQuaternionDecompositionSetScale(&d, number(s[0][0]), number(s[1][1]), number(s[2][2]));
    rtcQuaternionDecompositionSetSkew(&d, number(s[0][1]), number(s[0][2]), number(s[1][2]));
    return d;
}

std::array<float, 12> rows_of(const Transform& map) {
    std::array<float, 12> rows;
    for (size_t i = 0; i < 12; ++i) rows[i] = static_cast<float>(map.matrix().m[i / 4][i % 4]);
    return rows;
}

/// Embree's way from key to key: by decompositions, or element by element.
enum class Between { turning, straight };

void set_keys(const EmbreeDevice& device, RTCGeometry instance, const Motion& motion,
              const ShutterClock& clock, unsigned steps, Between between) {
    rtcSetGeometryTimeStepCount(instance, steps + 1);
    for (unsigned i = 0; i <= steps; ++i) {
        const Transform pose = motion.at(clock.key_time(i, steps));
        if (between == Between::straight) {
            rtcSetGeometryTransform(instance, i, RTC_FORMAT_FLOAT3X4_ROW_MAJOR,
                                    rows_of(pose).data());
        } else {
            const RTCQuaternionDecomposition key = decompose(pose);
            rtcSetGeometryTransformQuaternion(instance, i, &key);
        }
    }
    rtcCommitGeometry(instance);
    device.check();
}

/// Largest distance between the corners of `box` as Embree and as `motion` place them, relative to
/// the placed box's diagonal, less the cost of rounding the coordinates to single precision.
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
    rtcSetGeometryTransform(instance.get(), 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, rows_of(map).data());
    rtcCommitGeometry(instance.get());
    device.check();
    return instance;
}

GeometryHandle new_moving_instance(const EmbreeDevice& device, RTCScene scene, const Motion& motion,
                                   const ShutterClock& clock) {
    RTCBounds box;
    rtcGetSceneBounds(scene, &box);
    const auto error = [&](const GeometryHandle& instance, unsigned steps) {
        return interpolation_error(instance.get(), box, motion, clock, steps);
    };
    // Sets 2, 4, ... times as many keys until the error is below `enough`, or keys are as many as
    // `most`; returns the error.
    const auto refine = [&](const GeometryHandle& instance, Between between, unsigned first,
                            unsigned most, double enough) {
        for (unsigned steps = first;; steps *= 2) {
            set_keys(device, instance.get(), motion, clock, steps, between);
            const double left = error(instance, steps);
            if (left < enough || 2 * steps > most) return left;
        }
    };
    GeometryHandle turning = new_instance(device, scene);
    const unsigned least = clock.segments();
    const unsigned few = std::min(kMostSteps, least * kFewSteps);
    if (refine(turning, Between::turning, least, few, kInterpolationError) < kInterpolationError)
        return turning;
    GeometryHandle straight = new_instance(device, scene);
    const double left = refine(straight, Between::straight, least, kMostSteps, kPlacementError);
    if (left < kPlacementError) return straight;
    return refine(turning, Between::turning, least, kMostSteps, kInterpolationError) < left
               ? std::move(turning)
               : std::move(straight);
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
