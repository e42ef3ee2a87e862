/// An image whose channels lie one after the other in one block, so that numpy can show a channel
/// or a whole layer without copying it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "image/image.h"

namespace covtrace::python {

struct Planes {
    PixelBounds data, display;
    std::vector<std::string> names;  ///< names of the channels; those of one layer are neighbours
    std::vector<float> values;       ///< names.size() planes of data.width() * data.height()
    Metadata metadata;

    /// Takes an image apart, freeing each channel as it goes.
    explicit Planes(Image&& image);
    /// A copy of the image in the renderer's own form.
    Image image() const;

    size_t plane_size() const { return size_t(data.width()) * size_t(data.height()); }
};

using SharedPlanes = std::shared_ptr<Planes>;

}  // namespace covtrace::python
