#include "image/color_encoding.h"
#include "image/image.h"
#include "image/read_file.h"

namespace covtrace {

namespace {

std::string_view channel_names(int channels) {
    return channels < 3 ? std::string_view("YA") : std::string_view("RGBA");
}

}  // namespace

Image read_image(const std::filesystem::path& file) {
    const ImageFormat format = detect_image_format(file, {});
    if (format == ImageFormat::exr) return read_exr(file, {});

    const PlainImage plain = read_plain(file, format, {});
    const size_t pixels = size_t(plain.width) * size_t(plain.height);
    const MemoryReservation room(pixels * size_t(plain.channels) * sizeof(float),
                                 in_words(file, plain.width, plain.height));
    Image image;
    image.data = image.display = {0, 0, plain.width, plain.height};
    for (int c = 0; c < plain.channels; ++c) {
        Channel& channel =
            image.add_channel(std::string(1, channel_names(plain.channels)[size_t(c)]));
        const bool is_alpha = plain.has_alpha() && c == plain.channels - 1;
        const bool decode = plain.integer_bits > 0 && !is_alpha;
        for (size_t i = 0; i < channel.values.size(); ++i) {
            const float value = plain.value(i * size_t(plain.channels) + size_t(c));
            channel.values[i] = decode ? srgb_decode(value) : value;
        }
    }
    return image;
}

}  // namespace covtrace
