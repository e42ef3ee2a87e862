#include "foreign/denoise.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <string>
#include <utility>
#include <vector>

#include "bindings.h"
#include "core/parallel.h"
#include "image/finite_pixels.h"
#include "options.h"
#include "planes.h"
#include "python_lock.h"

namespace covtrace::python {

namespace py = pybind11;

namespace {

using FloatArray = py::array_t<float, py::array::c_style | py::array::forcecast>;

/// Channels by their names that an image gets beside its own.
using Additions = std::vector<std::pair<std::string, FloatArray>>;

NamedImage with_additions(const std::string& name, const Planes& planes, const Additions& added) {
    NamedImage named{name, planes.image()};
    Image& image = named.image;
    for (const auto& [channel, values] : added) {
        require(values.ndim() == 2 && values.shape(0) == image.height() &&
                    values.shape(1) == image.width(),
                "the arrays beside " + name + " must have its height and width");
        image.channels.push_back({channel, {values.data(), values.data() + values.size()}});
    }
    return named;
}

/// (image, estimated error, warnings)
py::tuple denoise_images(const std::vector<std::tuple<std::string, SharedPlanes, Additions>>& given,
                         const py::dict& o) {
    std::vector<NamedImage> images;
    for (const auto& [name, planes, added] : given)
        images.push_back(with_additions(name, *planes, added));
    const auto layer = [&](const char* name) {
        return is_given(o, name) ? value_of<std::string>(o, name, "a layer's name") : std::string();
    };
    DenoiseOptions options;
    options.layers = {layer("color"), layer("variance"), layer("albedo"), layer("normal"),
                      layer("depth")};
    options.samples = positive<float>(o, "samples", 1);
    const DenoiserSearch search = denoiser_search(o);
    options.quality = denoiser_quality(o).value_or(DenoiserQuality::high);
    const int threads = thread_count(o);
    DenoisedImage result;
    FoundDenoiser denoiser;
    {
        const Unlocked unlocked;
        const ThreadLimit limit(threads);
        denoiser = find_denoiser(search);
        options.denoiser = denoiser.denoiser.get();
        result = denoise(images, options);
    }
    std::vector<std::string> warnings;
    if (denoiser.is_unusable) warnings.push_back("no denoiser is used: " + denoiser.why_none);
    for (const Warning& w : result.warnings) warnings.push_back(w.text);
    if (const auto it = result.image.metadata.find("covtrace:denoiserFailure");
        it != result.image.metadata.end())
        warnings.push_back("the image is without the denoiser: " +
                           std::get<std::string>(it->second));
    if (const auto replaced = replaced_pixels(result.image.metadata))
        warnings.push_back(describe(*replaced));
    return py::make_tuple(std::make_shared<Planes>(std::move(result.image)), result.error,
                          warnings);
}

}  // namespace

void bind_denoise(py::module_& module) {
    module.def("denoise", &denoise_images);
}

}  // namespace covtrace::python
