#include "planes.h"

#include <algorithm>

namespace covtrace::python {

namespace {

std::string_view layer_of(std::string_view channel) {
    const size_t dot = channel.rfind('.');
    return dot == std::string_view::npos ? std::string_view() : channel.substr(0, dot);
}

}  // namespace

Planes::Planes(Image&& image) : data(image.data), display(image.display) {
    // Put the channels of a layer together: files sort channels by name, but the root's may be
    // apart
    std::vector<std::string_view> layers;
    for (const Channel& c : image.channels)
        if (std::find(layers.begin(), layers.end(), layer_of(c.name)) == layers.end())
            layers.push_back(layer_of(c.name));
    std::vector<Channel*> order;
    for (const std::string_view layer : layers)
        for (Channel& c : image.channels)
            if (layer_of(c.name) == layer) order.push_back(&c);
    // Put the channels of each layer in order: files keep R, G, B in alphabetical order, and the
    // root's "Z" is a layer of its own, behind its other channels
    const auto rank = [](const std::string& name) {
        if (name == "Z") return 5;
        const char last = name.back();
        return last == 'R' ? 0 : last == 'G' ? 1 : last == 'B' ? 2 : last == 'A' ? 3 : 4;
    };
    for (auto begin = order.begin(); begin != order.end();) {
        const std::string_view layer = layer_of((*begin)->name);
        auto end = std::find_if(begin, order.end(),
                                [&](const Channel* c) { return layer_of(c->name) != layer; });
        std::stable_sort(begin, end, [&](const Channel* a, const Channel* b) {
            return rank(a->name) < rank(b->name);
        });
        begin = end;
    }
    values.resize(order.size() * plane_size());
    size_t next = 0;
    for (Channel* c : order) {
        std::copy(c->values.begin(), c->values.end(), values.begin() + long(next));
        next += plane_size();
        c->values = {};
        names.push_back(c->name);
    }
    metadata = std::move(image.metadata);
}

Image Planes::image() const {
    Image result;
    result.data = data;
    result.display = display;
    result.metadata = metadata;
    for (size_t c = 0; c < names.size(); ++c) {
        const float* first = values.data() + c * plane_size();
        result.channels.push_back({names[c], {first, first + plane_size()}});
    }
    return result;
}

}  // namespace covtrace::python
