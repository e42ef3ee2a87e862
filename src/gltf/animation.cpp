#include "gltf/animation.h"

#include <algorithm>
#include <cmath>

#include "core/transform.h"
#include "gltf/extensions.h"

namespace covtrace::gltf {
namespace {

std::vector<double> slerp_values(double t, const float* a, const float* b) {
    const Quaternion q = slerp(t, {a[0], a[1], a[2], a[3]}, {b[0], b[1], b[2], b[3]});
    return {q.x, q.y, q.z, q.w};
}

}  // namespace

Matrix4 matrix_of(const Pose& p) {
    double x = p.rotation[0], y = p.rotation[1], z = p.rotation[2], w = p.rotation[3];
    const double size = std::sqrt(x * x + y * y + z * z + w * w);
    if (size > 0) x /= size, y /= size, z /= size, w /= size;
    const std::array<std::array<double, 3>, 3> r{
        {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
         {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
         {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}}};
    Matrix4 m;
    for (size_t row = 0; row < 3; ++row) {
        for (size_t column = 0; column < 3; ++column)
            m.m[row][column] = r[row][column] * p.scale[column];
        m.m[row][3] = p.translation[row];
    }
    return m;
}

Animations::Animations(const Document& document, const std::vector<size_t>& played,
                       WarningLog& log) {
    for (const size_t a : played)
        for (size_t c = 0; c < document.model.animations[a].channels.size(); ++c)
            read_channel(document, a, c, log);
}

std::array<float, 2> Animations::span() const {
    std::array<float, 2> span{kInfinity, -kInfinity};
    for (const auto& [node, channels] : channels_)
        for (const auto& [path, channel] : channels) {
            span[0] = std::min(span[0], channel.times.values.front());
            span[1] = std::max(span[1], channel.times.values.back());
        }
    return span;
}

void Animations::read_channel(const Document& document, size_t a, size_t c, WarningLog& log) {
    const tinygltf::Animation& animation = document.model.animations[a];
    const tinygltf::AnimationChannel& channel = animation.channels[c];
    const std::string place = element("animations", a) + "." + element("channels", c);
    warn_of_left_out(document, channel.target_extensions, place, log);
    if (channel.target_node < 0) return;  // the target belongs to an extension
    at(document, document.model.nodes, channel.target_node, "nodes", place + ".target.node");
    Path path{};
    if (channel.target_path == "translation") {
        path = Path::translation;
    } else if (channel.target_path == "rotation") {
        path = Path::rotation;
    } else if (channel.target_path == "scale") {
        path = Path::scale;
    } else if (channel.target_path == "weights") {
        path = Path::weights;
    } else {
        log.add(document.place(place),
                "only translation, rotation, scale and morph weights of nodes are animated; the "
                "rest is left out");
        return;
    }
    at(document, document.model.nodes, channel.target_node, "nodes", place + ".target.node");
    Channel read;
    read.path = path;
    const tinygltf::AnimationSampler& sampler =
        at(document, animation.samplers, channel.sampler, element("animations", a) + ".samplers",
           place + ".sampler");
    const std::string sampler_place =
        element("animations", a) + "." + element("samplers", static_cast<size_t>(channel.sampler));
    if (sampler.interpolation == "STEP")
        read.interpolation = Interpolation::step;
    else if (sampler.interpolation == "CUBICSPLINE")
        read.interpolation = Interpolation::cubic_spline;
    else if (sampler.interpolation != "LINEAR")
        document.refuse(sampler_place + ".interpolation", "expected LINEAR, STEP or CUBICSPLINE");
    read.times = read_numbers(document, sampler.input, 1, sampler_place + ".input");
    const size_t width = path == Path::weights ? 1 : path == Path::rotation ? 4 : 3;
    read.values = read_numbers(document, sampler.output, width, sampler_place + ".output");
    const size_t keys = read.times.count();
    const size_t expected = read.interpolation == Interpolation::cubic_spline ? 3 * keys : keys;
    const size_t found = read.values.count();
    if (path == Path::weights && expected > 0 && found >= expected && found % expected == 0)
        read.values.components = found / expected;  // all targets' weights, key by key
    else if (keys == 0 || found != expected)
        document.refuse(sampler_place, std::to_string(found) + " values for " +
                                           std::to_string(keys) + " times; expected " +
                                           std::to_string(expected) + ", and at least one time");
    if (!std::is_sorted(read.times.values.begin(), read.times.values.end()))
        document.refuse(sampler_place + ".input", "expected increasing times");
    if (!channels_[channel.target_node].emplace(path, std::move(read)).second)
        log.add(document.place(place),
                "another animation moves the same property of the node; the first one counts");
}

std::vector<double> Animations::Channel::at(double time) const {
    const std::vector<float>& t = times.values;
    const bool spline = interpolation == Interpolation::cubic_spline;
    const size_t width = values.components;
    const auto value = [&](size_t key) { return values.element(spline ? 3 * key + 1 : key); };
    const auto held = [&](size_t key) {
        return std::vector<double>(value(key), value(key) + width);
    };
    if (!(time > t.front())) return held(0);
    if (time >= t.back()) return held(t.size() - 1);
    const auto next = static_cast<size_t>(
        std::upper_bound(t.begin(), t.end(), static_cast<float>(time)) - t.begin());
    const size_t after = std::min(next, t.size() - 1), before = after - 1;
    const double length = double(t[after]) - double(t[before]);
    if (interpolation == Interpolation::step || !(length > 0)) return held(before);
    const double u = std::clamp((time - double(t[before])) / length, 0.0, 1.0);
    if (!spline && path == Path::rotation) return slerp_values(u, value(before), value(after));

    std::vector<double> result(width);
    for (size_t i = 0; i < width; ++i) {
        const double p0 = value(before)[i], p1 = value(after)[i];
        if (!spline) {
            result[i] = (1 - u) * p0 + u * p1;
            continue;
        }
        // Interpolate by a cubic Hermite spline (glTF 2.0, appendix C.5), whose tangents are per
        // second.
        const double out = length * double(values.element(3 * before + 2)[i]);
        const double in = length * double(values.element(3 * after)[i]);
        const double u2 = u * u, u3 = u2 * u;
        result[i] = (2 * u3 - 3 * u2 + 1) * p0 + (u3 - 2 * u2 + u) * out + (3 * u2 - 2 * u3) * p1 +
                    (u3 - u2) * in;
    }
    return result;
}

std::vector<double> Animations::weights(int node, double time) const {
    const auto it = channels_.find(node);
    if (it == channels_.end()) return {};
    const auto channel = it->second.find(Path::weights);
    return channel == it->second.end() ? std::vector<double>{} : channel->second.at(time);
}

void Animations::apply(int node, double time, Pose& pose) const {
    const auto it = channels_.find(node);
    if (it == channels_.end()) return;
    for (const auto& [path, channel] : it->second) {
        if (path == Path::weights) continue;
        const std::vector<double> v = channel.at(time);
        switch (path) {
            case Path::translation:
                std::copy(v.begin(), v.end(), pose.translation.begin());
                break;
            case Path::rotation:
                std::copy(v.begin(), v.end(), pose.rotation.begin());
                break;
            case Path::scale:
                std::copy(v.begin(), v.end(), pose.scale.begin());
                break;
            case Path::weights:
                break;
        }
    }
}

}  // namespace covtrace::gltf
