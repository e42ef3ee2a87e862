#include <cmath>
#include <cstdio>
#include <limits>

#include "image/image.h"

namespace covtrace {

namespace {

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
}

std::string describe(const PixelBounds& b) {
    return std::to_string(b.width()) + "x" + std::to_string(b.height()) + " pixels, x " +
           std::to_string(b.x0) + " to " + std::to_string(b.x1) + ", y " + std::to_string(b.y0) +
           " to " + std::to_string(b.y1);
}

std::string describe(const MetadataValue& value) {
    if (const auto* i = std::get_if<int>(&value)) return std::to_string(*i);
    if (const auto* f = std::get_if<float>(&value)) return number(*f);
    if (const auto* s = std::get_if<std::string>(&value)) return "\"" + *s + "\"";
    std::string text = "[";
    for (float f : std::get<std::vector<float>>(value))
        text += (text.size() > 1 ? " " : "") + number(f);
    return text + "]";
}

std::string layer_of(const std::string& channel) {
    const size_t dot = channel.rfind('.');
    return dot == std::string::npos ? std::string() : channel.substr(0, dot);
}

std::string describe(const Channel& channel) {
    float lowest = std::numeric_limits<float>::infinity(), highest = -lowest;
    double sum = 0;
    size_t finite = 0;
    for (float v : channel.values) {
        if (!std::isfinite(v)) continue;
        lowest = std::min(lowest, v);
        highest = std::max(highest, v);
        sum += v;
        ++finite;
    }
    const std::string layer = layer_of(channel.name);
    std::string text = "    " + channel.name.substr(layer.empty() ? 0 : layer.size() + 1) + ": ";
    text += finite == 0 ? "no finite values"
                        : number(lowest) + " to " + number(highest) + ", mean " +
                              number(sum / double(finite));
    if (finite != channel.values.size())
        text += ", " + std::to_string(channel.values.size() - finite) + " not finite";
    return text + "\n";
}

}  // namespace

std::string describe(const Image& image) {
    std::string text = "display window: " + describe(image.display) + "\n";
    if (image.data != image.display) text += "data window: " + describe(image.data) + "\n";
    std::map<std::string, std::string> layers;
    for (const Channel& channel : image.channels)
        layers[layer_of(channel.name)] += describe(channel);
    text += "layers:\n";
    for (const auto& [layer, channels] : layers)
        text += "  " + (layer.empty() ? "(root)" : layer) + "\n" + channels;
    if (!image.metadata.empty()) text += "metadata:\n";
    for (const auto& [name, value] : image.metadata)
        text += "  " + name + " = " + describe(value) + "\n";
    return text;
}

}  // namespace covtrace
