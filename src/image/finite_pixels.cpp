#include "image/finite_pixels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace covtrace {

namespace {

constexpr const char* kCount = "covtrace:replacedPixels";
constexpr const char* kFirst = "covtrace:firstReplacedPixel";
constexpr const char* kLayers = "covtrace:replacedLayers";

std::string layer_of(const std::string& channel) {
    const size_t dot = channel.rfind('.');
    if (dot != std::string::npos) return channel.substr(0, dot);
    return channel == "R" || channel == "G" || channel == "B" ? "image" : channel;
}

bool is_finite(const MetadataValue& value) {
    if (const auto* f = std::get_if<float>(&value)) return std::isfinite(*f);
    const auto* all = std::get_if<std::vector<float>>(&value);
    return !all || std::all_of(all->begin(), all->end(), [](float f) { return std::isfinite(f); });
}

float mean_of_neighbours(const std::vector<float>& values, int width, int height, size_t pixel) {
    const int x = int(pixel % size_t(width)), y = int(pixel / size_t(width));
    double sum = 0;
    int count = 0;
    for (int j = std::max(0, y - 1); j <= std::min(height - 1, y + 1); ++j)
        for (int i = std::max(0, x - 1); i <= std::min(width - 1, x + 1); ++i) {
            const float v = values[size_t(j) * size_t(width) + size_t(i)];
            if (!std::isfinite(v)) continue;
            sum += v;
            ++count;
        }
    return count > 0 ? float(sum / count) : 0;
}

bool tells_uncertainty(const std::string& layer) {
    return layer == "variance" || layer == "error";
}

/// Replaces the channel's bad values and marks their pixels in `is_bad`, which has one entry for
/// each pixel or none yet. True where there were any.
bool replace_in(Channel& channel, int width, int height, std::vector<bool>& is_bad) {
    std::vector<float>& values = channel.values;
    const bool nan_is_largest = tells_uncertainty(layer_of(channel.name));
    constexpr float kLargest = std::numeric_limits<float>::max();
    std::vector<std::pair<size_t, float>> better;
    for (size_t i = 0; i < values.size(); ++i)
        if (std::isnan(values[i]))
            better.emplace_back(
                i, nan_is_largest ? kLargest : mean_of_neighbours(values, width, height, i));
        else if (std::isinf(values[i]))
            better.emplace_back(i, std::copysign(kLargest, values[i]));
    if (!better.empty()) is_bad.resize(values.size());
    for (const auto& [i, value] : better) {
        values[i] = value;
        is_bad[i] = true;
    }
    return !better.empty();
}

}  // namespace

std::optional<ReplacedPixels> replace_nonfinite(Image& image) {
    ReplacedPixels replaced;
    std::vector<bool> is_bad;
    std::string last;
    for (Channel& channel : image.channels) {
        if (!replace_in(channel, image.width(), image.height(), is_bad)) continue;
        const std::string layer = layer_of(channel.name);
        if (layer != last) replaced.layers += (last.empty() ? "" : ", ") + layer;
        last = layer;
    }
    std::erase_if(image.metadata, [](const auto& entry) { return !is_finite(entry.second); });
    if (is_bad.empty()) return std::nullopt;
    replaced.pixels = int(std::count(is_bad.begin(), is_bad.end(), true));
    const auto first = int(std::find(is_bad.begin(), is_bad.end(), true) - is_bad.begin());
    replaced.x = image.data.x0 + first % image.width();
    replaced.y = image.data.y0 + first / image.width();
    image.metadata[kCount] = replaced.pixels;
    image.metadata[kFirst] = std::vector<float>{float(replaced.x), float(replaced.y)};
    image.metadata[kLayers] = replaced.layers;
    return replaced;
}

std::optional<ReplacedPixels> replaced_pixels(const Metadata& metadata) {
    const auto count = metadata.find(kCount), first = metadata.find(kFirst),
               layers = metadata.find(kLayers);
    if (count == metadata.end() || first == metadata.end() || layers == metadata.end())
        return std::nullopt;
    const auto* pixels = std::get_if<int>(&count->second);
    const auto* place = std::get_if<std::vector<float>>(&first->second);
    const auto* names = std::get_if<std::string>(&layers->second);
    if (!pixels || !place || place->size() != 2 || !names) return std::nullopt;
    return ReplacedPixels{*pixels, int((*place)[0]), int((*place)[1]), *names};
}

std::string describe(const ReplacedPixels& r) {
    return std::to_string(r.pixels) + (r.pixels == 1 ? " pixel has" : " pixels have") +
           " values that single precision cannot hold, replaced by the largest number or the mean "
           "of their neighbours; the first at " +
           std::to_string(r.x) + "," + std::to_string(r.y) + ", in the layers " + r.layers;
}

}  // namespace covtrace
