#include "image/image.h"

#include <stdexcept>

namespace covtrace {

const Channel* Image::find(std::string_view name) const {
    for (const Channel& channel : channels)
        if (channel.name == name) return &channel;
    return nullptr;
}

Channel& Image::add_channel(std::string name) {
    return channels.emplace_back(Channel{std::move(name), std::vector<float>(pixel_count())});
}

Rgb Image::rgb(size_t pixel, std::string_view prefix) const {
    const auto value = [&](char component) {
        const std::string name = std::string(prefix) + component;
        const Channel* channel = find(name);
        if (!channel) throw std::out_of_range("the image has no channel '" + name + "'");
        return channel->values.at(pixel);
    };
    return {value('R'), value('G'), value('B')};
}

}  // namespace covtrace
