#include "cli/image_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/pixel_description.h"

namespace covtrace::cli {

namespace {

Distribution distribution_of(std::vector<double> values) {
    std::erase_if(values, [](double v) { return !std::isfinite(v); });
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const auto at = [&](double share) {
        return values[size_t(std::lround(share * double(values.size() - 1)))];
    };
    double sum = 0;
    for (double v : values) sum += v;
    return {at(0), at(0.05), at(0.5), at(0.95), at(1), sum / double(values.size())};
}

/// The values value(pixel) of all pixels.
template <typename Value>
std::vector<double> for_pixels(const Image& image, const Value& value) {
    std::vector<double> values(image.pixel_count());
    for (size_t i = 0; i < values.size(); ++i) values[i] = value(i);
    return values;
}

void add_channel_quantity(ImageSummary& summary, const Image& image, const char* key,
                          const char* channel, const char* title) {
    if (const Channel* c = image.find(channel))
        summary.quantities.push_back(
            {key, title, distribution_of({c->values.begin(), c->values.end()})});
}

void add_filter(ImageSummary& summary, const Image& image) {
    const Channel *xx = image.find("filter.xx"), *xy = image.find("filter.xy"),
                  *yy = image.find("filter.yy");
    if (!xx || !xy || !yy) return;
    const auto axes = [&](size_t i) {
        return principal_axes(xx->values[i], xy->values[i], yy->values[i]);
    };
    summary.quantities.push_back(
        {"filter_width", "filter width, pixels", distribution_of(for_pixels(image, [&](size_t i) {
             const PrincipalAxes a = axes(i);
             return std::sqrt(a.major * a.minor);
         }))});
    summary.quantities.push_back({"filter_elongation", "filter length / width",
                                  distribution_of(for_pixels(image, [&](size_t i) {
                                      const PrincipalAxes a = axes(i);
                                      return a.minor > 0 ? a.major / a.minor : 1;
                                  }))});
}

/// The worst pixels, no two of them closer than a small neighbourhood.
std::vector<UncertainPixel> most_uncertain(const Image& image, double whole) {
    constexpr size_t kCount = 5;
    constexpr int kApart = 8;
    const std::vector<double> errors =
        for_pixels(image, [&](size_t i) { return relative_error(image, i).value_or(0); });
    std::vector<size_t> order(errors.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
        return errors[a] != errors[b] ? errors[a] > errors[b] : a < b;
    });
    std::vector<UncertainPixel> worst;
    for (size_t i : order) {
        if (worst.size() == kCount || !(errors[i] > 0)) break;
        const int x = image.data.x0 + int(i % size_t(image.width())),
                  y = image.data.y0 + int(i / size_t(image.width()));
        if (std::all_of(worst.begin(), worst.end(), [&](const UncertainPixel& w) {
                return std::max(std::abs(w.x - x), std::abs(w.y - y)) >= kApart;
            }))
            worst.push_back({x, y, *pixel_certainty(image, i, whole)});
    }
    return worst;
}

std::string metadata_text(const Image& image, const std::string& key) {
    const auto it = image.metadata.find(key);
    if (it == image.metadata.end()) return {};
    if (const auto* s = std::get_if<std::string>(&it->second)) return *s;
    if (const auto* f = std::get_if<float>(&it->second)) return format_number(*f);
    if (const auto* i = std::get_if<int>(&it->second)) return std::to_string(*i);
    return {};
}

/// One line about how our own images were made; empty for others.
std::string origin(const Image& image) {
    const std::string version = metadata_text(image, "covtrace:version");
    if (version.empty()) return {};
    std::string text = "covtrace " + version;
    for (const auto& [key, before, after] : {std::array{"covtrace:method", ", method ", ""},
                                             {"spp", ", ", " samples per pixel"},
                                             {"covtrace:seed", ", seed ", ""},
                                             {"covtrace:denoiser", ", ", ""},
                                             {"covtrace:denoiserQuality", ", ", " quality"},
                                             {"covtrace:seconds", ", ", " s"}})
        if (const std::string value = metadata_text(image, key); !value.empty())
            text += before + value + after;
    if (metadata_text(image, "complete") == "0") text += ", interrupted: not complete";
    return text;
}

nlohmann::json to_json(const Distribution& d) {
    return {{"least", d.least}, {"low", d.low},   {"median", d.median},
            {"high", d.high},   {"most", d.most}, {"mean", d.mean}};
}

}  // namespace

ImageSummary summarize(const Image& image) {
    ImageSummary summary;
    summary.origin = origin(image);
    for (const Channel& c : image.channels)
        summary.nonfinite += std::count_if(c.values.begin(), c.values.end(),
                                           [](float v) { return !std::isfinite(v); });
    add_channel_quantity(summary, image, "samples", "samples.Y", "samples");
    add_channel_quantity(summary, image, "density", "density.Y", "samples predicted");
    add_filter(summary, image);
    add_channel_quantity(summary, image, "error", "error.Y", "standard error");
    if (const auto error = image_error(image)) {
        summary.estimated_error = *error;
        summary.uncertain = most_uncertain(image, *error);
    }
    return summary;
}

std::string to_text(const ImageSummary& summary, const Image& image, const std::string& name) {
    std::string text = name + "\n";
    if (!summary.origin.empty()) text += summary.origin + "\n";
    if (!summary.quantities.empty())
        text += fmt::format("\n{:<22}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}\n", "per pixel", "least",
                            "5 %", "median", "95 %", "most", "mean");
    for (const auto& [key, title, d] : summary.quantities) {
        text += fmt::format("{:<22}", title);
        for (double v : {d.least, d.low, d.median, d.high, d.most, d.mean})
            text += fmt::format("{:>10}", format_number(v));
        text += "\n";
    }
    if (!summary.uncertain.empty()) {
        text += "\nestimated error of the image, sqrt(relMSE): " +
                format_number(summary.estimated_error) + "\nmost uncertain pixels:\n";
        for (const UncertainPixel& p : summary.uncertain)
            text +=
                fmt::format("  {:<10} {}\n", fmt::format("{},{}", p.x, p.y), p.certainty.sentence);
        text += fmt::format("  covtrace inspect {} --pixel {},{} tells more of one\n", name,
                            summary.uncertain[0].x, summary.uncertain[0].y);
    }
    if (summary.nonfinite > 0)
        text += fmt::format("\n{} values are not finite numbers\n", summary.nonfinite);
    return text + "\n" + describe(image);
}

nlohmann::json to_json(const ImageSummary& summary, const Image& image, const std::string& name) {
    const auto window = [](const PixelBounds& b) { return nlohmann::json{b.x0, b.y0, b.x1, b.y1}; };
    nlohmann::json j{{"file", name},
                     {"width", image.width()},
                     {"height", image.height()},
                     {"data_window", window(image.data)},
                     {"display_window", window(image.display)},
                     {"nonfinite", summary.nonfinite},
                     {"channels", nlohmann::json::object()},
                     {"metadata", nlohmann::json::object()}};
    for (const Channel& c : image.channels)
        j["channels"][c.name] = to_json(distribution_of({c.values.begin(), c.values.end()}));
    for (const auto& [key, value] : image.metadata)
        std::visit([&, &k = key](const auto& v) { j["metadata"][k] = v; }, value);
    for (const Quantity& q : summary.quantities) j[q.key] = to_json(q.distribution);
    if (summary.uncertain.empty()) return j;
    j["estimated_error"] = summary.estimated_error;
    for (const UncertainPixel& p : summary.uncertain)
        j["most_uncertain"].push_back({{"x", p.x},
                                       {"y", p.y},
                                       {"relative_error", p.certainty.relative_error},
                                       {"samples_factor", p.certainty.samples_factor},
                                       {"sentence", p.certainty.sentence}});
    return j;
}

}  // namespace covtrace::cli
