#include <array>
#include <csetjmp>
#include <cstdio>

#include <jpeglib.h>

#include <jerror.h>

#include "image/plain_image.h"

namespace covtrace {

namespace {

/// libjpeg reports errors through a callback that must not return: longjmp, over which no C++
/// object may be destroyed. Everything that has a destructor lives outside of the functions that
/// call it.
struct JpegReader {
    JpegReader() = default;
    JpegReader(const JpegReader&) = delete;
    JpegReader& operator=(const JpegReader&) = delete;
    ~JpegReader() { jpeg_destroy_decompress(&jpeg); }

    jpeg_decompress_struct jpeg{};
    jpeg_error_mgr errors{};
    jpeg_progress_mgr progress{};
    std::jmp_buf on_failure{};
    std::array<char, JMSG_LENGTH_MAX> message{};
    std::vector<JSAMPLE> row;
};

void on_error(j_common_ptr jpeg) {
    auto* reader = static_cast<JpegReader*>(jpeg->client_data);
    jpeg->err->format_message(jpeg, reader->message.data());
    std::longjmp(reader->on_failure, 1);
}

/// Treats missing data as an error: libjpeg would fill them with grey. Other warnings are harmless.
void on_warning(j_common_ptr jpeg, int level) {
    const int code = jpeg->err->msg_code;
    if (level < 0 && (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER)) on_error(jpeg);
}

/// Limits the scans of a progressive image: each costs a pass over all pixels, but few bytes.
void on_progress(j_common_ptr jpeg) {
    constexpr int kMostScans = 500;
    if (reinterpret_cast<j_decompress_ptr>(jpeg)->input_scan_number <= kMostScans) return;
    jpeg->err->msg_code = JERR_BAD_PROGRESSION;
    on_error(jpeg);
}

void on_output(j_common_ptr) {}

bool read_header(JpegReader& reader, Bytes bytes) {
    if (setjmp(reader.on_failure)) return false;
    jpeg_decompress_struct& jpeg = reader.jpeg;
    jpeg.err = jpeg_std_error(&reader.errors);
    jpeg.client_data = &reader;
    reader.errors.error_exit = on_error;
    reader.errors.emit_message = on_warning;
    reader.errors.output_message = on_output;
    jpeg_create_decompress(&jpeg);
    reader.progress.progress_monitor = on_progress;
    jpeg.progress = &reader.progress;
    jpeg_mem_src(&jpeg, bytes.data(), bytes.size());
    jpeg_read_header(&jpeg, TRUE);
    jpeg.out_color_space = jpeg.num_components == 1   ? JCS_GRAYSCALE
                           : jpeg.num_components == 4 ? JCS_CMYK
                                                      : JCS_RGB;
    return true;
}

bool start(JpegReader& reader) {
    if (setjmp(reader.on_failure)) return false;
    jpeg_start_decompress(&reader.jpeg);
    return true;
}

bool read_row(JpegReader& reader) {
    if (setjmp(reader.on_failure)) return false;
    JSAMPROW row = reader.row.data();
    jpeg_read_scanlines(&reader.jpeg, &row, 1);
    return true;
}

void append_row(PlainImage& image, const JpegReader& reader) {
    const size_t width = size_t(image.width), channels = size_t(image.channels);
    if (reader.jpeg.out_color_space != JCS_CMYK) {
        image.bytes.insert(image.bytes.end(), reader.row.begin(),
                           reader.row.begin() + ptrdiff_t(width * channels));
        return;
    }
    // CMYK files of Adobe hold the inks inverted: 255 is no ink.
    const auto without_ink = [&](JSAMPLE ink) {
        return unsigned(reader.jpeg.saw_Adobe_marker ? ink : 255 - ink);
    };
    for (size_t x = 0; x < width; ++x)
        for (size_t c = 0; c < 3; ++c)
            image.bytes.push_back(uint8_t(
                (without_ink(reader.row[4 * x + c]) * without_ink(reader.row[4 * x + 3]) + 127) /
                255));
}

}  // namespace

PlainImage decode_jpeg(Bytes bytes) {
    JpegReader reader;
    const auto fail = [&] { throw DecodeError(reader.message.data()); };
    if (!read_header(reader, bytes)) fail();
    const int components = reader.jpeg.num_components;
    const size_t width = reader.jpeg.image_width, height = reader.jpeg.image_height;
    // Images of several scans take more memory: the library keeps the coefficients of all pixels.
    const size_t coefficients = jpeg_has_multiple_scans(&reader.jpeg)
                                    ? width * height * size_t(components) * sizeof(JCOEF)
                                    : 0;
    PlainImage image =
        make_plain_image(int64_t(width), int64_t(height), components == 1 ? 1 : 3, 8, coefficients);
    if (!start(reader)) fail();
    reader.row.resize(size_t(image.width) * size_t(reader.jpeg.output_components));
    for (int y = 0; y < image.height; ++y) {
        if (!read_row(reader)) fail();
        append_row(image, reader);
    }
    return image;
}

}  // namespace covtrace
