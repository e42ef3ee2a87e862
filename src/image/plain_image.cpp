#include "image/plain_image.h"

#include <algorithm>
#include <string>

namespace covtrace {

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
    const std::string size = std::to_string(width) + "x" + std::to_string(height) + " pixels";
    if (width > kMostPixels / height) throw DecodeError(size + " are too many");
    if (channels > kMostValues / (width * height))
        throw DecodeError(size + " of " + std::to_string(channels) + " channels exceed 4 GiB");
}

PlainImage make_plain_image(int64_t width, int64_t height, int channels, int integer_bits) {
    check_image_size(width, height, channels);
    PlainImage image{int(width), int(height), channels, integer_bits, {}};
    image.values.reserve(size_t(width) * size_t(height) * size_t(channels));
    return image;
}

void flip_rows(PlainImage& image) {
    const auto row = ptrdiff_t(image.width) * image.channels;
    auto top = image.values.begin();
    auto bottom = image.values.end() - row;
    for (; top < bottom; top += row, bottom -= row) std::swap_ranges(top, top + row, bottom);
}

}  // namespace covtrace
