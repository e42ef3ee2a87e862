/// Private to this folder: decoders of plain pictures, from the bytes of a whole file to pixels.
///
/// Decoders throw DecodeError, and Error(limit) where a header claims more than the process may
/// hold (core/memory_limit.h). Nothing is printed, nothing large is allocated before the size in
/// the header has been checked, and pixels are appended while they are decoded, so that a short
/// file that claims to be large costs little.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

#include "core/memory_limit.h"

namespace covtrace {

struct DecodeError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Pixels as a file holds them, not decoded.
struct PlainImage {
    int width = 0, height = 0;
    int channels = 0;      ///< 1: grey, 2: grey and alpha, 3: R G B, 4: R G B A
    int integer_bits = 0;  ///< 8 or 16; 0: floating point
    /// Values of an 8-bit image, interleaved, row by row from the top.
    std::vector<uint8_t> bytes;
    /// Values of any other image, in the same order; integers scaled to [0, 1].
    std::vector<float> values;
    MemoryReservation room;  ///< memory set aside for the values until they are there

    bool is_8bit() const { return integer_bits == 8; }
    /// The i-th value as a float; integers are scaled to [0, 1].
    float value(size_t i) const { return is_8bit() ? float(bytes[i]) / 255.0f : values[i]; }
    bool has_alpha() const { return channels == 2 || channels == 4; }
};

/// Throws DecodeError unless an image of this size is reasonable: at least one pixel and channel,
/// at most 2^28 pixels and 4 GiB as float.
void check_image_size(int64_t width, int64_t height, int64_t channels);

/// Makes an image without values yet; checks its size and reserves address space. `meanwhile`:
/// bytes that the decoder itself needs.
PlainImage make_plain_image(int64_t width, int64_t height, int channels, int integer_bits,
                            size_t meanwhile = 0);

/// Mirrors the rows: the first becomes the last.
void flip_rows(PlainImage& image);

using Bytes = std::span<const uint8_t>;

/// PNG with all bit depths and colour types; palettes and transparent colours are expanded.
PlainImage decode_png(Bytes bytes);
/// JPEG in grey, YCbCr, RGB, CMYK and YCCK, sequential and progressive.
PlainImage decode_jpeg(Bytes bytes);
/// Truevision TGA: palette, colour, grey; raw and run-length encoded.
PlainImage decode_targa(Bytes bytes);
/// Radiance RGBE: flat, old and new run lengths. EXPOSURE is ignored, as in pbrt.
PlainImage decode_hdr(Bytes bytes);
/// PFM of either byte order, scaled by the magnitude of its scale; binary PGM and PPM.
PlainImage decode_pnm(Bytes bytes);
/// The "Quite OK Image" format, qoiformat.org, version 1.0; as floating point where its header says
/// that the colours are linear.
PlainImage decode_qoi(Bytes bytes);
/// WebP, with and without loss, with and without alpha; animations are refused.
PlainImage decode_webp(Bytes bytes);

}  // namespace covtrace
