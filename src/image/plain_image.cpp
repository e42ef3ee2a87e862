#include "image/plain_image.h"

#include <algorithm>
#include <string>

namespace covtrace {

namespace {

std::string pixels(int64_t width, int64_t height) {
    return std::to_string(width) + "x" + std::to_string(height) + " pixels";
}

template <typename Value>
void flip(std::vector<Value>& values, ptrdiff_t row) {
    auto top = values.begin();
    auto bottom = values.end() - row;
    for (; top < bottom; top += row, bottom -= row) std::swap_ranges(top, top + row, bottom);
}

}  // namespace

void check_image_size(int64_t width, int64_t height, int64_t channels) {
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
    constexpr int kMostPixelsLog = 20;
#else
    constexpr int kMostPixelsLog = 28;
#endif
    constexpr int64_t kMostPixels = int64_t(1) << kMostPixelsLog;
    constexpr int64_t kMostValues = 4 * kMostPixels;
    if (width <= 0 || height <= 0 || channels <= 0)
        throw DecodeError("it has no pixels or channels");
    const std::string size = pixels(width, height);
    if (width > kMostPixels / height) throw DecodeError(size + " are too many");
    if (channels > kMostValues / (width * height))
        throw DecodeError(size + " of " + std::to_string(channels) + " channels exceed 4 GiB");
}

PlainImage make_plain_image(int64_t width, int64_t height, int channels, int integer_bits,
                            size_t meanwhile) {
    check_image_size(width, height, channels);
    PlainImage image;
    image.width = int(width);
    image.height = int(height);
    image.channels = channels;
    image.integer_bits = integer_bits;
    const size_t count = size_t(width) * size_t(height) * size_t(channels);
    const size_t bytes = count * (image.is_8bit() ? 1 : sizeof(float));
    image.room = MemoryReservation(bytes + meanwhile, pixels(width, height));
    if (image.is_8bit())
        image.bytes.reserve(count);
    else
        image.values.reserve(count);
    return image;
}

void flip_rows(PlainImage& image) {
    const auto row = ptrdiff_t(image.width) * image.channels;
    if (image.is_8bit())
        flip(image.bytes, row);
    else
        flip(image.values, row);
}

}  // namespace covtrace
