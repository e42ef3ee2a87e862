#include <png.h>

#include <algorithm>
#include <csetjmp>
#include <cstddef>
#include <new>

#include "image/display.h"
#include "image/image.h"
#include "image/output_file.h"
#include "image/root_colour.h"

namespace covtrace {

namespace {

/// libpng reports errors by longjmp, over which no C++ object may be destroyed: everything that has
/// a destructor lives here, outside of the function that calls libpng.
struct PngWriter {
    PngWriter() = default;
    PngWriter(const PngWriter&) = delete;
    PngWriter& operator=(const PngWriter&) = delete;
    ~PngWriter() { png_destroy_write_struct(&png, &info); }

    png_structp png = nullptr;
    png_infop info = nullptr;
    std::string error;
    std::string encoded;
};

void on_error(png_structp png, png_const_charp text) {
    static_cast<PngWriter*>(png_get_error_ptr(png))->error = text;
    png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

void on_write(png_structp png, png_bytep bytes, size_t count) {
    bool appended = true;
    try {
        static_cast<PngWriter*>(png_get_io_ptr(png))
            ->encoded.append(reinterpret_cast<const char*>(bytes), count);
    } catch (const std::bad_alloc&) {
        appended = false;
    }
    if (!appended) png_error(png, "not enough memory");
}

void on_flush(png_structp) {}

/// Whether a file says that its colours are sRGB. Without a word most programs take them for that,
/// too, others for those of the display.
enum class Colours { srgb, untold };

bool encode(PngWriter& writer, const uint8_t* rgb, int width, int height, Colours colours) {
    if (setjmp(png_jmpbuf(writer.png))) return false;
    png_set_write_fn(writer.png, &writer, on_write, on_flush);
    png_set_IHDR(writer.png, writer.info, png_uint_32(width), png_uint_32(height), 8,
                 PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    if (colours == Colours::srgb)
        png_set_sRGB_gAMA_and_cHRM(writer.png, writer.info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(writer.png, writer.info);
    for (int y = 0; y < height; ++y) png_write_row(writer.png, rgb + size_t(y) * size_t(width) * 3);
    png_write_end(writer.png, writer.info);
    return true;
}

std::string encoded(std::span<const uint8_t> rgb, int width, int height, Colours colours) {
    if (width <= 0 || height <= 0 || rgb.size() != size_t(width) * size_t(height) * 3)
        throw Error(ErrorKind::internal, "PNG: the pixels do not match the image's size");
    PngWriter writer;
    writer.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &writer, on_error, on_warning);
    writer.info = writer.png ? png_create_info_struct(writer.png) : nullptr;
    if (!writer.info) throw std::bad_alloc();
    if (!encode(writer, rgb.data(), width, height, colours))
        throw Error(ErrorKind::io, "cannot encode a PNG: " + writer.error);
    return std::move(writer.encoded);
}

void write(std::span<const uint8_t> rgb, int width, int height, const std::filesystem::path& file,
           Colours colours) {
    // The target is opened first: if it cannot be written there is no reason to compress.
    OutputFile output(file);
    const std::string bytes = encoded(rgb, width, height, colours);
    output.write(bytes.data(), bytes.size());
    output.commit();
}

}  // namespace

std::string encode_png_rgb8(std::span<const uint8_t> rgb, int width, int height) {
    return encoded(rgb, width, height, Colours::srgb);
}

void write_png_rgb8(std::span<const uint8_t> rgb, int width, int height,
                    const std::filesystem::path& file) {
    write(rgb, width, height, file, Colours::srgb);
}

void write_png(const Image& image, const std::filesystem::path& file,
               const DisplayOptions& options) {
    const RootColour colour = root_colour(image, file);
    const auto value = [&](size_t c, size_t i) { return colour.channels[c]->values[i]; };
    std::vector<uint8_t> rgb(image.pixel_count() * 3);
    for (size_t i = 0; i < image.pixel_count(); ++i) {
        const auto shown = display_8bit({value(0, i), value(1, i), value(2, i)}, options);
        std::copy(shown.begin(), shown.end(), rgb.begin() + std::ptrdiff_t(i * 3));
    }
    // A config's display may be another one than sRGB, and the library does not tell which.
    write(rgb, image.width(), image.height(), file, options.ocio ? Colours::untold : Colours::srgb);
}

void write_png(const Image& image, const std::filesystem::path& file) {
    write_png(image, file, DisplayOptions{});
}

}  // namespace covtrace
