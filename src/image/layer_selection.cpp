#include "image/layer_selection.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "core/enum_names.h"
#include "core/error.h"

namespace covtrace {

namespace {

constexpr std::array<std::string_view, 13> kStandard{
    "A",       "Z",       "raw",    "albedo",   "N",   "variance", "error",
    "samples", "density", "filter", "spectrum", "cov", "covweight"};
/// Layers of the first surfaces, which are made where they are named and for pbrt's "gbuffer".
constexpr std::array<std::string_view, 5> kSurfaces{"P", "Ng", "uv", "dz", "relvariance"};
/// Layers that must be asked for by name: those that tell emitters in view apart from scattered
/// light, those for denoisers alone, and what each kind of candidate made.
constexpr std::array<std::string_view, 7> kParts{
    "inview",        "inviewfilter", "scatteredcov", "scatteredcovweight",
    "featurealbedo", "featureN",     "share"};

template <typename Names>
bool contains(const Names& names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

/// The name that selects a channel: "raw" of "raw.R", "Z" of "Z".
std::string layer_of(const Channel& c) {
    return c.name.substr(0, c.name.rfind('.'));
}

std::optional<std::string_view> layer_named(std::string_view text) {
    const auto is_it = [text](std::string_view name) { return is_same_name(name, text); };
    for (const std::span<const std::string_view> names :
         {std::span<const std::string_view>(kStandard), {kSurfaces}, {kParts}})
        if (const auto at = std::find_if(names.begin(), names.end(), is_it); at != names.end())
            return *at;
    return std::nullopt;
}

/// All names that a selection may have, with commas.
std::string known() {
    std::string text;
    const auto add = [&text](const auto& names) {
        for (std::string_view name : names) text += (text.empty() ? "" : ",") + std::string(name);
    };
    add(kStandard);
    add(kSurfaces);
    add(kParts);
    return text;
}

bool is_selected(const Channel& c, const LayerSelection& selection) {
    const bool root = c.name.find('.') == std::string::npos && c.name != "Z";
    const std::string layer = layer_of(c);
    return root || (selection.all && !contains(kParts, layer)) || contains(selection.names, layer);
}

}  // namespace

LayerSelection parse_layers(const std::string& option, const std::string& text) {
    LayerSelection selection;
    bool is_none = false;
    for (size_t from = 0; from <= text.size();) {
        const size_t to = std::min(text.find(',', from), text.size());
        const std::string name = text.substr(from, to - from);
        if (is_same_name(name, "all"))
            selection.all = true;
        else if (is_same_name(name, "none"))
            is_none = true;
        else if (const auto layer = layer_named(name))
            selection.names.emplace_back(*layer);
        else
            throw Error(ErrorKind::usage, option + ": there is no layer '" + name +
                                              "'; expected none, all, or some of " + known());
        from = to + 1;
    }
    if (is_none && (selection.all || !selection.names.empty()))
        throw Error(ErrorKind::usage, option + ": 'none' stands alone, not with other layers");
    return selection;
}

bool names(const LayerSelection& selection, const std::string& layer) {
    return contains(selection.names, layer);
}

bool names_surfaces(const LayerSelection& selection) {
    return std::any_of(selection.names.begin(), selection.names.end(),
                       [](const std::string& name) { return contains(kSurfaces, name); });
}

std::vector<std::string> absent_layers(const Image& image, const LayerSelection& selection) {
    std::vector<std::string> absent;
    for (const std::string& name : selection.names)
        if (std::none_of(image.channels.begin(), image.channels.end(),
                         [&](const Channel& c) { return layer_of(c) == name; }))
            absent.push_back(name);
    return absent;
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

}  // namespace covtrace
