#include <png.h>

#include <array>
#include <csetjmp>
#include <cstring>

#include "image/plain_image.h"

namespace covtrace {

namespace {

/// libpng reports errors by longjmp, over which no C++ object may be destroyed: everything that has
/// a destructor lives here, outside of the functions that call libpng.
struct PngReader {
    explicit PngReader(Bytes data) : bytes(data) {}
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;
    ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }

    Bytes bytes;
    png_structp png = nullptr;
    png_infop info = nullptr;
    std::array<char, 200> error{};
    png_uint_32 width = 0, height = 0;
    int channels = 0, bits = 0, passes = 0;
    std::vector<png_byte> pixels;  ///< one row, or all of an interlaced image
};

void on_error(png_structp png, png_const_charp text) {
    auto* reader = static_cast<PngReader*>(png_get_error_ptr(png));
    std::strncpy(reader->error.data(), text, reader->error.size() - 1);
    png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

void on_read(png_structp png, png_bytep to, size_t count) {
    auto* reader = static_cast<PngReader*>(png_get_io_ptr(png));
    if (count > reader->bytes.size()) png_error(png, "the file ends too early");
    std::memcpy(to, reader->bytes.data(), count);
    reader->bytes = reader->bytes.subspan(count);
}

bool read_header(PngReader& reader) {
    if (setjmp(png_jmpbuf(reader.png))) return false;
    png_set_read_fn(reader.png, &reader, on_read);
    // Unknown chunks (colour profiles, texts and the like) are dropped: they are of no use here,
    // and a way to make a reader work hard.
    png_set_keep_unknown_chunks(reader.png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
    png_read_info(reader.png, reader.info);
    png_set_expand(reader.png);
    reader.passes = png_set_interlace_handling(reader.png);
    png_read_update_info(reader.png, reader.info);
    reader.width = png_get_image_width(reader.png, reader.info);
    reader.height = png_get_image_height(reader.png, reader.info);
    reader.channels = png_get_channels(reader.png, reader.info);
    reader.bits = png_get_bit_depth(reader.png, reader.info);
    return true;
}

bool read_row(PngReader& reader, png_bytep row) {
    if (setjmp(png_jmpbuf(reader.png))) return false;
    png_read_row(reader.png, row, nullptr);
    return true;
}

void append_row(PlainImage& image, const png_byte* row) {
    const size_t count = size_t(image.width) * size_t(image.channels);
    if (image.is_8bit())
        image.bytes.insert(image.bytes.end(), row, row + count);
    else
        for (size_t i = 0; i < count; ++i)
            image.values.push_back(float(row[2 * i] << 8 | row[2 * i + 1]) / 65535.0f);
}

}  // namespace

PlainImage decode_png(Bytes bytes) {
    PngReader reader(bytes);
    const auto fail = [&] { throw DecodeError(reader.error.data()); };
    reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, on_error, on_warning);
    reader.info = reader.png ? png_create_info_struct(reader.png) : nullptr;
    if (!reader.info) throw std::bad_alloc();
    if (!read_header(reader)) fail();

    const size_t row = png_get_rowbytes(reader.png, reader.info);
    PlainImage image =
        make_plain_image(reader.width, reader.height, reader.channels, reader.bits,
                         reader.passes > 1 && reader.bits != 8 ? row * reader.height : 0);
    if (reader.passes == 1) {
        reader.pixels.resize(row);
        for (int y = 0; y < image.height; ++y) {
            if (!read_row(reader, reader.pixels.data())) fail();
            append_row(image, reader.pixels.data());
        }
        return image;
    }
    // Interlaced images are decoded as a whole, because every pass changes all of it; 8-bit ones in
    // place.
    std::vector<png_byte>& all = image.is_8bit() ? image.bytes : reader.pixels;
    all.resize(row * reader.height);
    for (int pass = 0; pass < reader.passes; ++pass)
        for (size_t y = 0; y < reader.height; ++y)
            if (!read_row(reader, all.data() + y * row)) fail();
    if (image.is_8bit()) return image;
    for (size_t y = 0; y < reader.height; ++y) append_row(image, all.data() + y * row);
    return image;
}

}  // namespace covtrace
