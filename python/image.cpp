#include "image/write_image.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>

#include "bindings.h"
#include "core/parallel.h"
#include "image/compare.h"
#include "image/exr_names.h"
#include "image/layer_names.h"
#include "options.h"
#include "planes.h"
#include "python_lock.h"
#include "warning_texts.h"

namespace covtrace::python {

namespace py = pybind11;

namespace {

/// An array (height, width) or (height, width, count) of the channels [first, first + count), on
/// the image's own memory, which it keeps alive.
py::array_t<float> view(const SharedPlanes& planes, size_t first, size_t count, bool flat) {
    const auto w = py::ssize_t(planes->data.width()), h = py::ssize_t(planes->data.height());
    const auto item = py::ssize_t(sizeof(float));
    std::vector<py::ssize_t> shape{h, w}, strides{w * item, item};
    if (!flat) {
        shape.push_back(py::ssize_t(count));
        strides.push_back(w * h * item);
    }
    return py::array_t<float>(shape, strides, planes->values.data() + first * planes->plane_size(),
                              py::cast(planes));
}

/// A layer of an exported image: its name, first channel and number of channels.
struct Layer {
    std::string name;
    size_t first, count;
};

std::vector<Layer> layers_of(const Planes& planes) {
    std::vector<Layer> layers;
    for (size_t c = 0; c < planes.names.size(); ++c) {
        const size_t dot = planes.names[c].rfind('.');
        const std::string name = dot == std::string::npos ? "" : planes.names[c].substr(0, dot);
        // The channel "Z" beside R, G, B is a layer of its own.
        const bool depth = name.empty() && planes.names[c] == "Z";
        const std::string layer = depth ? "Z" : name;
        if (layers.empty() || layers.back().name != layer)
            layers.push_back({layer, c, 1});
        else
            ++layers.back().count;
    }
    return layers;
}

py::dict layer_views(const SharedPlanes& planes) {
    py::dict result;
    for (const Layer& l : layers_of(*planes))
        result[py::str(l.name)] = view(planes, l.first, l.count, l.count == 1 && !l.name.empty());
    return result;
}

py::dict channel_views(const SharedPlanes& planes) {
    py::dict result;
    for (size_t c = 0; c < planes->names.size(); ++c)
        result[py::str(planes->names[c])] = view(planes, c, 1, true);
    return result;
}

using FloatArray = py::array_t<float, py::array::c_style | py::array::forcecast>;

using Window = std::array<int, 4>;

/// Makes an image of (height, width) values by channel name, all of one size. `data` and `display`
/// are the windows (x0, y0, x1, y1); without them both begin at (0, 0).
SharedPlanes from_channels(const std::vector<std::pair<std::string, FloatArray>>& channels,
                           const std::optional<Window>& data,
                           const std::optional<Window>& display) {
    if (channels.empty()) throw py::value_error("an image needs at least one channel");
    const FloatArray& first = channels.front().second;
    if (first.ndim() != 2)
        throw py::value_error("channel '" + channels.front().first +
                              "' must be a (height, width) array");
    Image image;
    image.data = image.display = {0, 0, int(first.shape(1)), int(first.shape(0))};
    if (display) image.display = {(*display)[0], (*display)[1], (*display)[2], (*display)[3]};
    if (data) image.data = {(*data)[0], (*data)[1], (*data)[2], (*data)[3]};
    if (image.width() != first.shape(1) || image.height() != first.shape(0))
        throw py::value_error("the data window has not the size of the channels");
    std::set<std::string_view> names;
    for (const auto& [name, values] : channels) {
        if (name.empty() || name.size() > kExrNameLimit)
            throw py::value_error("'" + name + "' is no name for a channel");
        if (!names.insert(name).second)
            throw py::value_error("two channels are called '" + name + "'");
        if (values.ndim() != 2 || values.shape(0) != first.shape(0) ||
            values.shape(1) != first.shape(1) || values.size() == 0)
            throw py::value_error("channel '" + name +
                                  "' must be a (height, width) array of the image's size");
        image.channels.push_back({name, {values.data(), values.data() + values.size()}});
    }
    return std::make_shared<Planes>(std::move(image));
}

py::dict comparison(const SharedPlanes& image, const SharedPlanes& reference) {
    Comparison c;
    {
        const Unlocked unlocked;
        c = compare(image->image(), reference->image());
    }
    const py::ssize_t w = c.bounds.width(), h = c.bounds.height();
    py::array_t<float> flip_map({h, w});
    std::copy(c.flip_map.begin(), c.flip_map.end(), flip_map.mutable_data());
    py::dict result;
    result["mse"] = c.mse;
    result["relmse"] = c.relmse;
    result["relmse_trimmed"] = c.relmse_trimmed;
    result["relmse_median"] = c.relmse_median;
    result["psnr"] = c.psnr;
    result["flip"] = c.flip;
    result["mean_ratio"] = py::make_tuple(c.mean_ratio[0], c.mean_ratio[1], c.mean_ratio[2]);
    result["decile_ratio"] = py::tuple(py::cast(c.decile_ratio));
    result["nonfinite"] = c.nonfinite;
    result["identical"] = c.identical;
    result["flip_map"] = flip_map;
    return result;
}

}  // namespace

void bind_image(py::module_& module) {
    const auto window = [](const PixelBounds& b) { return py::make_tuple(b.x0, b.y0, b.x1, b.y1); };
    py::class_<Planes, SharedPlanes>(module, "Planes")
        .def_static("from_channels", &from_channels, py::arg("channels"),
                    py::arg("data_window") = py::none(), py::arg("display_window") = py::none())
        .def_static("read",
                    [](const std::filesystem::path& file) {
                        const Unlocked unlocked;
                        Image image = read_image(file);
                        restore_layer_names(image);
                        return std::make_shared<Planes>(std::move(image));
                    })
        .def("write",
             [](const Planes& p, const std::filesystem::path& file, float exposure,
                const std::string& view, const std::filesystem::path& ocio_config,
                const std::string& ocio_display, const std::string& ocio_look,
                const std::string& ocio_source) {
                 require(std::isfinite(exposure), "exposure must be a finite number of stops");
                 const Unlocked unlocked;
                 const DisplayOptions display = display_options(
                     exposure, view, {ocio_config, ocio_display, {}, ocio_look, ocio_source});
                 write_image(p.image(), file, ThreadLimit(0).threads(), display);
                 return display.ocio ? texts_of(display.ocio->warnings())
                                     : std::vector<std::string>();
             })
        .def("channels", &channel_views)
        .def("layers", &layer_views)
        .def("compare", &comparison)
        .def("describe", [](const Planes& p) { return describe(p.image()); })
        .def_property_readonly(
            "size", [](const Planes& p) { return py::make_tuple(p.data.width(), p.data.height()); })
        .def_property_readonly("data_window", [window](const Planes& p) { return window(p.data); })
        .def_property_readonly("display_window",
                               [window](const Planes& p) { return window(p.display); })
        .def_property(
            "metadata", [](const Planes& p) { return p.metadata; },
            [](Planes& p, Metadata metadata) { p.metadata = std::move(metadata); });
}

}  // namespace covtrace::python
