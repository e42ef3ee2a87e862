#include "gltf/animation.h"

#include <algorithm>
#include <cmath>

#include "core/transform.h"
#include "gltf/extensions.h"
#include "scene/names.h"

namespace covtrace::gltf {

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
    const auto extend = [&](const std::array<float, 2>& by) {
        span[0] = std::min(span[0], by[0]);
        span[1] = std::max(span[1], by[1]);
    };
    for (const auto& [node, channels] : channels_)
        for (const auto& [path, channel] : channels) extend(channel.span());
    if (!properties_.empty()) extend(properties_.span());
    return span;
}

void Animations::read_channel(const Document& document, size_t a, size_t c, WarningLog& log) {
    const tinygltf::AnimationChannel& channel = document.model.animations[a].channels[c];
    const std::string place = element("animations", a) + "." + element("channels", c);
    warn_of_left_out(document, channel.target_extensions, place, log);
    int node = channel.target_node;
    std::string property = channel.target_path;
    const auto warn_of_second = [&](bool is_first) {
        if (!is_first)
            log.add(document.place(place),
                    "another animation moves the same property; the first one counts");
    };
    if (const auto* target = extension(channel.target_extensions, "KHR_animation_pointer")) {
        const tinygltf::Value& text = target->Get("pointer");
        const std::string pointer = text.IsString() ? text.Get<std::string>() : std::string();
        const std::vector<std::string> path = pointer_path(pointer);
        if (AnimatedProperties::has(document, path))
            return warn_of_second(properties_.add(
                path,
                Channel(document, a, channel.sampler, AnimatedProperties::kind_of(path), place)));
        const auto named = path.size() == 3 && path[0] == "nodes"
                               ? pointer_index(path[1], document.model.nodes.size())
                               : std::nullopt;
        if (!named) {
            log.add(document.place(place),
                    "what KHR_animation_pointer moves here rests: " + pointer_in_quotes(pointer) +
                        " is nothing of a node, mesh, material, camera or light of the file");
            return;
        }
        node = static_cast<int>(*named);
        property = path[2];
    }
    if (node < 0) return;  // the target belongs to an extension
    at(document, document.model.nodes, node, "nodes", place + ".target.node");
    Path path{};
    ValueKind kind = ValueKind::vector3;
    if (property == "translation") {
        path = Path::translation;
    } else if (property == "rotation") {
        path = Path::rotation;
        kind = ValueKind::rotation;
    } else if (property == "scale") {
        path = Path::scale;
    } else if (property == "weights") {
        path = Path::weights;
        kind = ValueKind::list;
    } else {
        log.add(document.place(place),
                "only translation, rotation, scale and morph weights of nodes are animated; the "
                "rest is left out");
        return;
    }
    warn_of_second(
        channels_[node].emplace(path, Channel(document, a, channel.sampler, kind, place)).second);
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
