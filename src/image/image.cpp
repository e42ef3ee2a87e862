#include "image/image.h"

#include <cassert>
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

Image cropped(const Image& image, const PixelBounds& bounds) {
    assert(!bounds.empty() && image.data.contains(bounds));
    Image part{bounds, image.display, {}, image.metadata};
    for (const Channel& from : image.channels) {
        Channel& to = part.channels.emplace_back(Channel{from.name, {}});
        to.values.reserve(part.pixel_count());
        for (int y = bounds.y0; y < bounds.y1; ++y) {
            const auto row = from.values.begin() + ptrdiff_t(y - image.data.y0) * image.width() +
                             (bounds.x0 - image.data.x0);
            to.values.insert(to.values.end(), row, row + bounds.width());
        }
    }
    return part;
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
