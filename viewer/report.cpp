#include "viewer/report.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>

#include "core/parallel.h"
#include "image/output_file.h"
#include "viewer/encode_plane.h"
#include "viewer/page.h"

namespace covtrace::viewer {

namespace {

using nlohmann::json;

std::string layer_of(const std::string& channel) {
    const size_t dot = channel.rfind('.');
    // The channel Z at the root is no colour, but a layer of its own.
    if (dot == std::string::npos) return channel == "Z" ? "Z" : "";
    return channel.substr(0, dot);
}

std::string component_of(const std::string& channel) {
    const size_t dot = channel.rfind('.');
    return dot == std::string::npos ? channel : channel.substr(dot + 1);
}

/// Rank of a layer by its importance for a page, 0 for the one that it needs most.
size_t importance(const std::string& layer) {
    constexpr std::array<std::string_view, 14> kOrder{
        "",          "error", "samples", "density", "share", "filter", "spectrum",
        "covweight", "cov",   "raw",     "albedo",  "N",     "Z",      "variance"};
    return size_t(std::find(kOrder.begin(), kOrder.end(), layer) - kOrder.begin());
}

struct Layer {
    size_t image;
    std::string name;
    std::vector<const Channel*> channels;  ///< R G B A in this order, others by name
};

std::vector<Layer> layers_of(const Image& image, size_t index) {
    std::vector<Layer> layers;
    for (const Channel& channel : image.channels) {
        const std::string name = layer_of(channel.name);
        auto it = std::find_if(layers.begin(), layers.end(),
                               [&](const Layer& l) { return l.name == name; });
        if (it == layers.end()) it = layers.insert(it, Layer{index, name, {}});
        it->channels.push_back(&channel);
    }
    const auto place = [](const Channel* c) {
        const std::string component = component_of(c->name);
        const size_t color = std::string_view("RGBA").find(component);
        return std::pair(component.size() == 1 ? color : std::string::npos, component);
    };
    for (Layer& layer : layers)
        std::sort(layer.channels.begin(), layer.channels.end(),
                  [&](const Channel* a, const Channel* b) { return place(a) < place(b); });
    return layers;
}

std::string text_of(const MetadataValue& value) {
    if (const auto* s = std::get_if<std::string>(&value)) return *s;
    std::ostringstream text;
    if (const auto* i = std::get_if<int>(&value)) text << *i;
    if (const auto* f = std::get_if<float>(&value)) text << *f;
    if (const auto* v = std::get_if<std::vector<float>>(&value))
        for (size_t k = 0; k < v->size(); ++k) text << (k > 0 ? " " : "") << (*v)[k];
    return text.str();
}

json to_json(const std::vector<Fact>& facts) {
    json list = json::array();
    for (const Fact& fact : facts) {
        list.push_back({fact.name, fact.value});
        if (fact.pixel) list.back().push_back(*fact.pixel);
    }
    return list;
}

/// JSON that cannot end the element it stands in, and pure ASCII; bytes that are no UTF-8 are
/// replaced.
std::string for_script_element(const json& value) {
    std::string text;
    for (char c : value.dump(-1, ' ', true, json::error_handler_t::replace)) {
        if (c == '<' || c == '>' || c == '&')
            text += c == '<' ? "\\u003c" : (c == '>' ? "\\u003e" : "\\u0026");
        else
            text += c;
    }
    return text;
}

/// The encoded planes of a page, within the bytes that it may have.
class PlaneList {
  public:
    PlaneList(uint64_t most_bytes, size_t pixels) : most_(most_bytes), pixels_(pixels) {}

    /// Takes all of these planes or, where they would not fit, none. Returns their indices.
    std::vector<size_t> add(const std::vector<std::span<const float>>& values) {
        // Planes that cannot fit are not encoded: noise compresses to about three quarters.
        if (bytes_ + values.size() * pixels_ / 2 > most_) return {};
        std::vector<EncodedPlane> encoded(values.size());
        parallel_for(int64_t(values.size()),
                     [&](int64_t i) { encoded[size_t(i)] = encode_plane(values[size_t(i)]); });
        uint64_t size = 0;
        for (const EncodedPlane& plane : encoded) size += plane.text.size();
        if (bytes_ + size > most_) return {};
        bytes_ += size;
        std::vector<size_t> places;
        for (EncodedPlane& plane : encoded) {
            places.push_back(planes_.size());
            planes_.push_back(std::move(plane));
        }
        return places;
    }
    const std::vector<EncodedPlane>& planes() const { return planes_; }

  private:
    uint64_t most_, bytes_ = 0;
    size_t pixels_;
    std::vector<EncodedPlane> planes_;
};

void check(const Report& report) {
    for (const ReportImage& i : report.images)
        if (i.image->data.empty() || i.image->data != report.images.front().image->data)
            throw Error(ErrorKind::internal, "the images of a report have different pixels");
    if (report.images.empty()) throw Error(ErrorKind::internal, "a report without images");
}

}  // namespace

std::vector<OmittedLayer> write_report(const Report& report, const std::filesystem::path& file,
                                       uint64_t most_bytes) {
    check(report);
    const PixelBounds& window = report.images.front().image->data;
    PlaneList planes(most_bytes, report.images.front().image->pixel_count());
    std::vector<OmittedLayer> omitted;

    // List the images and, by importance, their layers
    json images = json::array();
    std::vector<Layer> layers;
    for (size_t i = 0; i < report.images.size(); ++i) {
        const ReportImage& r = report.images[i];
        json metadata = json::array();
        for (const auto& [name, value] : r.image->metadata)
            metadata.push_back({name, text_of(value)});
        images.push_back({{"name", r.name},
                          {"facts", to_json(r.facts)},
                          {"metadata", std::move(metadata)},
                          {"layers", json::array()},
                          {"flip", json::object()},
                          {"omitted", json::array()}});
        for (Layer& layer : layers_of(*r.image, i)) layers.push_back(std::move(layer));
    }
    std::stable_sort(layers.begin(), layers.end(), [](const Layer& a, const Layer& b) {
        return importance(a.name) < importance(b.name);
    });

    // Encode the planes as long as they fit; error maps come after the images' colours
    const auto add_flip = [&] {
        for (size_t i = 0; i < report.images.size(); ++i)
            for (const auto& [other, map] : report.images[i].flip) {
                const std::vector<size_t> place = planes.add({map});
                if (!place.empty()) images[i]["flip"][std::to_string(other)] = place[0];
            }
    };
    bool flip_added = false;
    for (const Layer& layer : layers) {
        if (!layer.name.empty() && !flip_added) {
            add_flip();
            flip_added = true;
        }
        std::vector<std::span<const float>> values;
        for (const Channel* c : layer.channels) values.emplace_back(c->values);
        const std::vector<size_t> places = planes.add(values);
        if (places.empty()) {
            if (layer.name.empty())
                throw Error(ErrorKind::limit, "the images are too large for a page of " +
                                                  std::to_string(most_bytes >> 20) +
                                                  " MiB; show a crop of them");
            images[layer.image]["omitted"].push_back(layer.name);
            omitted.push_back({layer.image, layer.name});
            continue;
        }
        json channels = json::array();
        for (size_t c = 0; c < places.size(); ++c)
            channels.push_back(
                {{"name", component_of(layer.channels[c]->name)}, {"plane", places[c]}});
        images[layer.image]["layers"].push_back(
            {{"name", layer.name}, {"channels", std::move(channels)}});
    }
    if (!flip_added) add_flip();

    // Describe them for the page
    json descriptions = json::array();
    for (const EncodedPlane& plane : planes.planes())
        descriptions.push_back({{"half", plane.half}});
    json data = {{"title", report.title},
                 {"width", window.width()},
                 {"height", window.height()},
                 {"x0", window.x0},
                 {"y0", window.y0},
                 {"images", std::move(images)},
                 {"facts", to_json(report.facts)},
                 {"planes", std::move(descriptions)}};
    if (report.pixel) data["pixel"] = *report.pixel;

    // Write the page
    const PageFrame frame = page_frame();
    OutputFile out(file);
    const auto write = [&](std::string_view text) { out.write(text.data(), text.size()); };
    write(frame.before);
    // Data stands in elements of a type that is no script; browsers don't run them.
    write("<script type=\"application/json\" id=\"report\">");
    write(for_script_element(data));
    write("</script>\n");
    for (size_t i = 0; i < planes.planes().size(); ++i) {
        write("<script type=\"application/octet-stream\" id=\"plane-" + std::to_string(i) + "\">");
        write(planes.planes()[i].text);
        write("</script>\n");
    }
    write(frame.behind);
    out.commit();
    return omitted;
}

}  // namespace covtrace::viewer
