#include "cli/layer_selection.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace covtrace::cli {

namespace {

bool is_selected(const Channel& c, const LayerSelection& selection) {
    const size_t dot = c.name.rfind('.');
    const bool root = dot == std::string::npos && c.name != "Z";
    const auto& names = selection.names;
    return root || selection.all ||
           std::find(names.begin(), names.end(), c.name.substr(0, dot)) != names.end();
}

}  // namespace

LayerSelection parse_layers(const std::string& option, const std::string& text) {
    constexpr std::array<std::string_view, 13> kKnown{
        "A",       "Z",       "raw",    "albedo",   "N",   "variance", "error",
        "samples", "density", "filter", "spectrum", "cov", "covweight"};
    if (text == "all" || text == "none") return {text == "all", {}};
    LayerSelection selection;
    for (size_t from = 0; from <= text.size();) {
        const size_t to = std::min(text.find(',', from), text.size());
        selection.names.push_back(text.substr(from, to - from));
        from = to + 1;
    }
    for (const std::string& name : selection.names)
        if (std::find(kKnown.begin(), kKnown.end(), name) == kKnown.end())
            throw Error(ErrorKind::usage,
                        fmt::format("{}: there is no layer '{}'; expected all, none or some of {}",
                                    option, name, fmt::join(kKnown, ",")));
    return selection;
}

void keep_layers(Image& image, const LayerSelection& selection) {
    std::erase_if(image.channels, [&](const Channel& c) { return !is_selected(c, selection); });
}

Image copy_layers(const Image& image, const LayerSelection& selection) {
    Image copy{image.data, image.display, {}, {}};
    for (const Channel& c : image.channels)
        if (is_selected(c, selection)) copy.channels.push_back(c);
    return copy;
}

}  // namespace covtrace::cli
