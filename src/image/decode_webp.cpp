#include <webp/decode.h>

#include "image/plain_image.h"

namespace covtrace {

namespace {

const char* reason(VP8StatusCode status) {
    switch (status) {
        case VP8_STATUS_NOT_ENOUGH_DATA:
            return "the file ends too early";
        case VP8_STATUS_UNSUPPORTED_FEATURE:
            return "it uses a feature that libwebp does not decode";
        default:
            return "its WebP data are damaged";
    }
}

/// The library's configuration with the pixels that it decodes, freed at the end. They are the
/// library's own: it fills them while it decodes, so that a short file that claims to be large
/// costs little.
struct WebpPixels {
    WebpPixels() {
        if (!WebPInitDecoderConfig(&config)) throw DecodeError("libwebp is of another version");
    }
    WebpPixels(const WebpPixels&) = delete;
    WebpPixels& operator=(const WebpPixels&) = delete;
    ~WebpPixels() { WebPFreeDecBuffer(&config.output); }

    WebPDecoderConfig config{};
};

}  // namespace

PlainImage decode_webp(Bytes bytes) {
    WebpPixels pixels;
    const WebPBitstreamFeatures& found = pixels.config.input;
    VP8StatusCode status = WebPGetFeatures(bytes.data(), bytes.size(), &pixels.config.input);
    if (status != VP8_STATUS_OK) throw DecodeError(reason(status));
    if (found.has_animation) throw DecodeError("it is an animation");
    const int channels = found.has_alpha ? 4 : 3;
    const auto count = static_cast<size_t>(found.width) * static_cast<size_t>(found.height);
    // The library holds the pixels, and four bytes more of each where nothing was lost.
    PlainImage image = make_plain_image(found.width, found.height, channels, 8,
                                        count * (static_cast<size_t>(channels) + 4));
    pixels.config.output.colorspace = found.has_alpha ? MODE_RGBA : MODE_RGB;
    status = WebPDecode(bytes.data(), bytes.size(), &pixels.config);
    if (status == VP8_STATUS_OUT_OF_MEMORY) throw std::bad_alloc();
    if (status != VP8_STATUS_OK) throw DecodeError(reason(status));
    const WebPRGBABuffer& rows = pixels.config.output.u.RGBA;
    for (int y = 0; y < image.height; ++y) {
        const uint8_t* row = rows.rgba + static_cast<ptrdiff_t>(y) * rows.stride;
        image.bytes.insert(image.bytes.end(), row, row + image.width * channels);
    }
    return image;
}

}  // namespace covtrace
