/// The encoding of a plane of values as text that the page's planes.js reads; private to this
/// folder.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace covtrace::viewer {

/// A plane as text, lossless but for the payload of NaNs. The values are 16-bit floats where all of
/// them are such, else 32-bit floats, little endian; byte k of all values comes before byte k + 1
/// of all values (neighbouring values share their high bytes, so that these compress well);
/// deflated (zlib); base64.
struct EncodedPlane {
    bool half = false;
    std::string text;
};
EncodedPlane encode_plane(std::span<const float> values);

}  // namespace covtrace::viewer
