#include <array>

#include "image/byte_reader.h"
#include "image/plain_image.h"

namespace covtrace {

namespace {

struct Pixel {
    uint8_t r = 0, g = 0, b = 0, a = 255;
};

/// The state that the chunks of the format refer to.
class QoiReader {
  public:
    explicit QoiReader(ByteReader& reader) : reader_(reader) {}

    Pixel next() {
        if (run_ > 0) {
            --run_;
            return pixel_;
        }
        const int chunk = reader_.u8();
        if (chunk == 0xfe || chunk == 0xff)
            read_plain(chunk == 0xff);
        else if (chunk >> 6 == 0)
            pixel_ = seen_[size_t(chunk)];
        else if (chunk >> 6 == 1)
            move((chunk >> 4 & 3) - 2, (chunk >> 2 & 3) - 2, (chunk & 3) - 2);
        else if (chunk >> 6 == 2)
            move_by_green((chunk & 63) - 32);
        else
            run_ = chunk & 63;
        const size_t slot = size_t(pixel_.r * 3 + pixel_.g * 5 + pixel_.b * 7 + pixel_.a * 11) % 64;
        return seen_[slot] = pixel_;
    }

  private:
    void read_plain(bool with_alpha) {
        const Bytes b = reader_.take(with_alpha ? 4 : 3);
        pixel_ = {b[0], b[1], b[2], with_alpha ? b[3] : pixel_.a};
    }
    void move(int red, int green, int blue) {
        pixel_.r = uint8_t(pixel_.r + red);
        pixel_.g = uint8_t(pixel_.g + green);
        pixel_.b = uint8_t(pixel_.b + blue);
    }
    void move_by_green(int green) {
        const int others = reader_.u8();
        move(green - 8 + (others >> 4), green, green - 8 + (others & 15));
    }

    ByteReader& reader_;
    std::array<Pixel, 64> seen_ = [] {
        std::array<Pixel, 64> zero;
        zero.fill({0, 0, 0, 0});
        return zero;
    }();
    Pixel pixel_;
    int run_ = 0;
};

}  // namespace

PlainImage decode_qoi(Bytes bytes) {
    ByteReader reader(bytes);
    reader.take(4);
    const int64_t width = reader.big_u32(), height = reader.big_u32();
    const int channels = reader.u8();
    // Linear colours make the file one of floating point, for which nothing is to be decoded.
    constexpr int kLinear = 1;
    const bool is_linear = reader.u8() == kLinear;
    if (channels != 3 && channels != 4) throw DecodeError("it has neither 3 nor 4 channels");
    PlainImage image = make_plain_image(width, height, channels, is_linear ? 0 : 8);
    QoiReader pixels(reader);
    for (int64_t i = 0; i < width * height; ++i) {
        const Pixel p = pixels.next();
        const std::array<uint8_t, 4> components{p.r, p.g, p.b, p.a};
        for (size_t c = 0; c < size_t(channels); ++c)
            if (is_linear)
                image.values.push_back(float(components[c]) / 255.0f);
            else
                image.bytes.push_back(components[c]);
    }
    return image;
}

}  // namespace covtrace
