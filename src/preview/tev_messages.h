/// The messages that the viewer tev takes over TCP.
///
/// Each message has a uint32 length of all of it, one byte of kind, and contents; integers and
/// floats are little endian, texts end with a zero byte (tev's Ipc, version 1.19 and later).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "image/image.h"

namespace covtrace {

/// The message CreateImage: an image of this size, black, under this name; replaces an image of the
/// same name. With `focus` tev shows it.
std::string tev_create_image(const std::string& name, bool focus, int width, int height,
                             const std::vector<std::string>& channels);

/// The message UpdateImageV3: new values of all `channels` in the rows [y0, y1) of the image's data
/// window, placed where they are in the display window.
std::string tev_update_image(const std::string& name, const Image& image, int y0, int y1);

}  // namespace covtrace
