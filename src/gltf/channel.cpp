#include "gltf/channel.h"

#include <algorithm>
#include <cmath>

#include "core/transform.h"

namespace covtrace::gltf {
namespace {

std::vector<double> slerp_values(double t, const float* a, const float* b) {
    const Quaternion q = slerp(t, {a[0], a[1], a[2], a[3]}, {b[0], b[1], b[2], b[3]});
    return {q.x, q.y, q.z, q.w};
}

/// Numbers of an element of a sampler's output.
size_t components_of(const Document& document, ValueKind kind, int output,
                     const std::string& place) {
    switch (kind) {
        case ValueKind::vector3:
            return 3;
        case ValueKind::rotation:
            return 4;
        case ValueKind::list:
            return 1;
        case ValueKind::any:
        case ValueKind::positive:
            break;
    }
    const tinygltf::Accessor& accessor =
        at(document, document.model.accessors, output, "accessors", place);
    return static_cast<size_t>(
        std::max(1, tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type))));
}

}  // namespace

Channel::Channel(const Document& document, size_t animation, int sampler_index, ValueKind kind,
                 const std::string& place)
    : kind_(kind) {
    const std::string samplers = element("animations", animation) + ".samplers";
    const tinygltf::AnimationSampler& sampler =
        gltf::at(document, document.model.animations[animation].samplers, sampler_index, samplers,
                 place + ".sampler");
    const std::string here = element(samplers, static_cast<size_t>(sampler_index));
    if (sampler.interpolation == "STEP")
        interpolation_ = Interpolation::step;
    else if (sampler.interpolation == "CUBICSPLINE")
        interpolation_ = Interpolation::cubic_spline;
    else if (sampler.interpolation != "LINEAR")
        document.refuse(here + ".interpolation", "expected LINEAR, STEP or CUBICSPLINE");
    times_ = read_numbers(document, sampler.input, 1, here + ".input");
    const size_t components = components_of(document, kind, sampler.output, here + ".output");
    values_ = read_numbers(document, sampler.output, components, here + ".output");
    const size_t keys = times_.count();
    const size_t expected = interpolation_ == Interpolation::cubic_spline ? 3 * keys : keys;
    const size_t found = values_.count();
    if (components == 1 && expected > 0 && found >= expected && found % expected == 0)
        values_.components = found / expected;  // all numbers of a list, key by key
    else if (keys == 0 || found != expected)
        document.refuse(here, std::to_string(found) + " values for " + std::to_string(keys) +
                                  " times; expected " + std::to_string(expected) +
                                  ", and at least one time");
    if (!std::is_sorted(times_.values.begin(), times_.values.end()))
        document.refuse(here + ".input", "expected increasing times");
}

std::vector<double> Channel::at(double time) const {
    const std::vector<float>& t = times_.values;
    const bool spline = interpolation_ == Interpolation::cubic_spline;
    const size_t width = values_.components;
    const auto value = [&](size_t key) { return values_.element(spline ? 3 * key + 1 : key); };
    const auto held = [&](size_t key) {
        return std::vector<double>(value(key), value(key) + width);
    };
    if (!(time > t.front())) return held(0);
    if (time >= t.back()) return held(t.size() - 1);
    const auto next = static_cast<size_t>(
        std::upper_bound(t.begin(), t.end(), static_cast<float>(time)) - t.begin());
    const size_t after = std::min(next, t.size() - 1), before = after - 1;
    const double length = double(t[after]) - double(t[before]);
    if (interpolation_ == Interpolation::step || !(length > 0)) return held(before);
    const double u = std::clamp((time - double(t[before])) / length, 0.0, 1.0);
    if (!spline && kind_ == ValueKind::rotation)
        return slerp_values(u, value(before), value(after));

    std::vector<double> result(width);
    for (size_t i = 0; i < width; ++i) {
        const double p0 = value(before)[i], p1 = value(after)[i];
        if (!spline) {
            result[i] = (1 - u) * p0 + u * p1;
            continue;
        }
        // Interpolate by a cubic Hermite spline (glTF 2.0, appendix C.5), whose tangents are per
        // second.
        const double out = length * double(values_.element(3 * before + 2)[i]);
        const double in = length * double(values_.element(3 * after)[i]);
        const double u2 = u * u, u3 = u2 * u;
        result[i] = (2 * u3 - 3 * u2 + 1) * p0 + (u3 - 2 * u2 + u) * out + (3 * u2 - 2 * u3) * p1 +
                    (u3 - u2) * in;
        if (kind_ == ValueKind::positive && p0 >= 0 && p1 >= 0)
            result[i] = std::max(result[i], 0.0);
    }
    return result;
}

}  // namespace covtrace::gltf
