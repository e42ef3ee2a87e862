#include "image/layer_names.h"

#include <array>
#include <optional>
#include <utility>

namespace covtrace {

namespace {

/// Two texts that begin a channel's name, or are all of it where they don't end in a dot: in our
/// images, and in those of another convention.
struct Prefix {
    std::string_view ours, theirs;
};

constexpr std::array<Prefix, 9> kPbrt{Prefix{"albedo.", "Albedo."},
                                      {"N.", "Ns."},
                                      {"Ng.", "N."},
                                      {"variance.", "Variance."},
                                      {"relvariance.", "RelativeVariance."},
                                      {"uv.X", "u"},
                                      {"uv.Y", "v"},
                                      {"dz.X", "dzdx"},
                                      {"dz.Y", "dzdy"}};

// Names are renamed by the first prefix that fits. Whole names come first: no name may begin with
// an earlier prefix that means something else.
constexpr std::string_view kViewLayer = "ViewLayer.";
constexpr std::array<Prefix, 9> kBlender{
    Prefix{"filter.xx", "filter.X"}, {"filter.xy", "filter.Y"},
    {"filter.yy", "filter.Z"},       {"spectrum.xx", "spectrum.X"},
    {"spectrum.xy", "spectrum.Y"},   {"spectrum.yy", "spectrum.Z"},
    {"raw.", "Noisy Image."},        {"albedo.", "Denoising Albedo."},
    {"N.", "Denoising Normal."}};
/// Layers of a single number, which becomes channel X of its pass.
constexpr std::array<Prefix, 4> kBlenderNumbers{Prefix{"samples.Y", "Debug Sample Count.X"},
                                                {"error.Y", "error.X"},
                                                {"density.Y", "density.X"},
                                                {"covweight.Y", "covweight.X"}};

template <size_t N>
std::optional<std::string> translate(const std::string& name, const std::array<Prefix, N>& table,
                                     bool inverse) {
    for (const auto& [ours, theirs] : table) {
        const std::string_view from = inverse ? theirs : ours, to = inverse ? ours : theirs;
        if (from.ends_with('.') ? name.starts_with(from) : name == from)
            return std::string(to) + name.substr(from.size());
    }
    return std::nullopt;
}

std::string blender_name(const std::string& name) {
    std::string pass = name;
    if (name.find('.') == std::string::npos)
        pass = (name == "Z" ? "Depth." : "Combined.") + name;
    else if (name.starts_with("cov."))
        pass = "cov " + name.substr(4) + ".X";
    else if (name.starts_with("share."))
        pass = "share " + name.substr(6) + ".X";
    else if (const auto number = translate(name, kBlenderNumbers, false))
        pass = *number;
    else if (const auto known = translate(name, kBlender, false))
        pass = *known;
    return std::string(kViewLayer) + pass;
}

std::string name_from_blender(const std::string& pass) {
    for (std::string_view root : {"Combined.", "Depth."})
        if (pass.starts_with(root)) return pass.substr(root.size());
    if (pass.starts_with("cov ") && pass.ends_with(".X"))
        return "cov." + pass.substr(4, pass.size() - 6);
    if (pass.starts_with("share ") && pass.ends_with(".X"))
        return "share." + pass.substr(6, pass.size() - 8);
    if (const auto number = translate(pass, kBlenderNumbers, true)) return *number;
    return translate(pass, kBlender, true).value_or(pass);
}

/// The view layer of a file of Blender's with its dot, empty in other files: the first that has
/// features, or else the first that is not the compositor's. A file's first part, mostly Combined,
/// has no layer's name, which another pass tells.
std::string view_layer_of(const Image& image) {
    std::string composite;
    for (const std::string_view known : {".Denoising Albedo.R", ".Combined.R"})
        for (const Channel& c : image.channels) {
            if (!c.name.ends_with(known)) continue;
            std::string layer = c.name.substr(0, c.name.size() - known.size() + 1);
            if (layer != "Composite.") return layer;
            composite = std::move(layer);
        }
    return composite;
}

}  // namespace

void rename_layers(Image& image, LayerNames names) {
    if (names == LayerNames::standard) return;
    for (Channel& c : image.channels)
        c.name = names == LayerNames::blender ? blender_name(c.name)
                                              : translate(c.name, kPbrt, false).value_or(c.name);
}

void restore_layer_names(Image& image) {
    if (image.find("Albedo.R")) {
        for (Channel& c : image.channels) c.name = translate(c.name, kPbrt, true).value_or(c.name);
        return;
    }
    const std::string layer = view_layer_of(image);
    if (layer.empty()) return;
    for (Channel& c : image.channels)
        if (c.name.starts_with(layer)) c.name = name_from_blender(c.name.substr(layer.size()));
}

}  // namespace covtrace
