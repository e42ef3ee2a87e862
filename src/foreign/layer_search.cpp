#include "foreign/layer_search.h"

#include <array>
#include <charconv>
#include <set>
#include <span>
#include <string_view>

#include "core/error.h"

namespace covtrace {

namespace {

using Names = std::span<const std::string_view>;

// Names in the order in which they are preferred.
constexpr auto kColor = std::to_array<std::string_view>({"raw", "", "Ci"});
constexpr auto kVariance = std::to_array<std::string_view>({"variance", "Variance"});
constexpr auto kAlbedo =
    std::to_array<std::string_view>({"featurealbedo", "albedo", "Albedo", "Denoising Albedo",
                                     "denoise_albedo", "VRayDiffuseFilter"});
constexpr auto kNormal =
    std::to_array<std::string_view>({"featureN", "Ns", "N", "Denoising Normal", "normal", "normals",
                                     "Normal", "nn", "sh_normal", "VRayNormals"});
constexpr auto kDepth = std::to_array<std::string_view>(
    {"Z", "Denoising Depth", "depth", "Depth", "dd", "dd.y", "z", "VRayZDepth"});
constexpr auto kPlace = std::to_array<std::string_view>({"P"});

/// The channel `suffix` of a layer. The root's have no dot, RenderMan writes small letters, and
/// pbrt-v4 wrote "Nsx" once.
const Channel* channel_of(const Image& image, std::string_view layer, char suffix) {
    const std::string before = layer.empty() ? "" : std::string(layer) + ".";
    const char small = char(suffix - 'A' + 'a');
    for (const char letter : {suffix, small})
        if (const Channel* c = image.find(before + letter)) return c;
    if (!layer.empty() && suffix >= 'X' && suffix <= 'Z')
        return image.find(std::string(layer) + small);
    return nullptr;
}

std::optional<LayerChannels> triple(const Image& image, std::string_view layer) {
    for (std::string_view suffixes : {"RGB", "XYZ"}) {
        LayerChannels found{};
        for (size_t k = 0; k < 3; ++k) found[k] = channel_of(image, layer, suffixes[k]);
        if (found[0] && found[1] && found[2]) return found;
    }
    return std::nullopt;
}

/// The only channel of a layer, whatever its letter is.
const Channel* single(const Image& image, std::string_view layer) {
    if (const Channel* whole = image.find(layer)) return whole;
    const Channel* found = nullptr;
    for (const Channel& c : image.channels) {
        const size_t dot = c.name.rfind('.');
        if (dot == std::string::npos || std::string_view(c.name).substr(0, dot) != layer) continue;
        if (found) return nullptr;
        found = &c;
    }
    return found;
}

std::string layers_of(const Image& image) {
    std::set<std::string> names;
    for (const Channel& c : image.channels) {
        const size_t dot = c.name.rfind('.');
        names.insert(dot == std::string::npos ? c.name : c.name.substr(0, dot));
    }
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
}

/// The layer of three channels that the user named, or else the first known one; empty where there
/// is none.
std::optional<LayerChannels> search(const Image& image, const std::string& named, Names known,
                                    std::string_view option, const std::string& file) {
    if (named == "none") return std::nullopt;
    if (!named.empty()) {
        const auto found = triple(image, named == "root" ? "" : named);
        if (!found)
            throw Error(ErrorKind::usage, OptionName{option},
                        file + " has no layer '" + named +
                            "' with the channels R, G, B or X, Y, Z; there are " +
                            layers_of(image));
        return found;
    }
    for (std::string_view name : known)
        if (const auto found = triple(image, name)) return found;
    return std::nullopt;
}

void search_depth(const Image& image, const std::string& named, const std::string& file,
                  FoundLayers& found) {
    if (named == "none") return;
    if (!named.empty()) {
        found.depth = single(image, named);
        if (!found.depth) found.place = triple(image, named);
        if (!found.depth && !found.place)
            throw Error(ErrorKind::usage, OptionName{"depth"},
                        file + " has no layer '" + named +
                            "' with one channel, or with X, Y, Z; there are " + layers_of(image));
        return;
    }
    for (std::string_view name : kDepth)
        if ((found.depth = single(image, name))) return;
    for (std::string_view name : kPlace)
        if ((found.place = triple(image, name))) return;
}

/// The entry "cycles.ViewLayer.samples", a text: the most samples that a pixel may get.
std::optional<float> cycles_samples(const Image& image) {
    for (const auto& [key, value] : image.metadata) {
        const std::string* text = std::get_if<std::string>(&value);
        if (!text || !key.starts_with("cycles.") || !key.ends_with(".samples")) continue;
        int number = 0;
        const auto [end, error] =
            std::from_chars(text->data(), text->data() + text->size(), number);
        if (error == std::errc() && end == text->data() + text->size()) return float(number);
    }
    return std::nullopt;
}

}  // namespace

FoundLayers find_layers(const Image& image, const LayerNaming& naming, const std::string& file) {
    FoundLayers found;
    const auto color = search(image, naming.color, kColor, "color", file);
    if (!color)
        throw Error(ErrorKind::usage, OptionName{"color"},
                    file +
                        " has no channels R, G, B; expected the name of the layer with the "
                        "noisy colour, of " +
                        layers_of(image));
    found.color = *color;
    found.variance = search(image, naming.variance, kVariance, "variance", file);
    found.albedo = search(image, naming.albedo, kAlbedo, "albedo", file);
    found.normal = search(image, naming.normal, kNormal, "normal", file);
    search_depth(image, naming.depth, file, found);
    found.samples = single(image, "samples");
    found.samples_unit = cycles_samples(image).value_or(1);
    found.is_variance_of_one = image.metadata.contains("samplesPerPixel");
    return found;
}

std::optional<float> samples_in_metadata(const Image& image) {
    for (const char* key : {"spp", "samplesPerPixel"}) {
        const auto it = image.metadata.find(key);
        if (it == image.metadata.end()) continue;
        if (const float* number = std::get_if<float>(&it->second)) return *number;
        if (const int* number = std::get_if<int>(&it->second)) return float(*number);
    }
    return cycles_samples(image);
}

}  // namespace covtrace
