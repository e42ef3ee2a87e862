/// Private to this folder: a plane of values as text that the page's planes.js reads.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace covtrace::viewer {

/// Lossless but for the payload of NaNs. The values as 16-bit floats where all of them are such,
/// else as 32-bit floats, little endian; byte k of all values before byte k + 1 of all values
/// (neighbouring values share their high bytes, so that these compress well); deflated (zlib);
/// base64.
struct EncodedPlane {
    bool half = false;
    std::string text;
};
EncodedPlane encode_plane(std::span<const float> values);

}  // namespace covtrace::viewer
