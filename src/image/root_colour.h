/// Private to this folder: the colour of an image's root layer, for formats that hold no other.
#pragma once

#include <array>
#include <filesystem>

#include "image/image.h"

namespace covtrace {

struct RootColour {
    std::array<const Channel*, 3> channels{};  ///< R, G, B; of a grey image all of them are Y
    bool is_grey = false;
};

/// The root layer's channels. Throws Error(internal), which names `file`, for an image that has
/// neither R, G, B nor Y.
RootColour root_colour(const Image& image, const std::filesystem::path& file);

}  // namespace covtrace
