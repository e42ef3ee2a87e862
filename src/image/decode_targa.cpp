#include <array>

#include "image/byte_reader.h"
#include "image/plain_image.h"

namespace covtrace {

namespace {

/// Header of a file (Truevision TGA File Format Specification 2.0, section "TGA file header").
struct Header {
    int id_length, palette_type, image_type;
    int palette_first, palette_count, palette_bits;
    int width, height, pixel_bits, descriptor;

    bool run_length() const { return image_type & 8; }
    int color_type() const { return image_type & 7; }
    int alpha_bits() const { return descriptor & 15; }
    bool from_right() const { return descriptor & 0x10; }
    bool from_top() const { return descriptor & 0x20; }
};
constexpr int kPalette = 1, kColor = 2, kGrey = 3;

Header read_header(ByteReader& reader) {
    Header h{};
    h.id_length = reader.u8();
    h.palette_type = reader.u8();
    h.image_type = reader.u8();
    h.palette_first = reader.little_u16();
    h.palette_count = reader.little_u16();
    h.palette_bits = reader.u8();
    reader.take(4);
    h.width = reader.little_u16();
    h.height = reader.little_u16();
    h.pixel_bits = reader.u8();
    h.descriptor = reader.u8();
    if (h.palette_type > 1 || (h.image_type & ~8) < kPalette || (h.image_type & ~8) > kGrey)
        throw DecodeError("it is no TGA image");
    return h;
}

using Pixel = std::array<uint8_t, 4>;

/// Reads a colour, which is stored as B, G, R, A or as 1 + 5 + 5 + 5 bits.
Pixel read_color(ByteReader& reader, int bits) {
    if (bits == 15 || bits == 16) {
        const int packed = reader.little_u16();
        const auto part = [&](int shift) {
            return uint8_t(float(packed >> shift & 31) / 31 * 255 + 0.5f);
        };
        return {part(10), part(5), part(0), 255};
    }
    if (bits != 24 && bits != 32)
        throw DecodeError("TGA colours of " + std::to_string(bits) + " bits");
    const Bytes b = reader.take(size_t(bits / 8));
    return {b[2], b[1], b[0], bits == 32 ? b[3] : uint8_t(255)};
}

Pixel read_grey(ByteReader& reader, int bits) {
    if (bits != 8 && bits != 16)
        throw DecodeError("TGA greys of " + std::to_string(bits) + " bits");
    const Bytes b = reader.take(size_t(bits / 8));
    return {b[0], bits == 16 ? b[1] : uint8_t(255), 0, 0};
}

std::vector<Pixel> read_palette(ByteReader& reader, const Header& h) {
    std::vector<Pixel> palette;
    if (h.palette_type == 1)
        for (int i = 0; i < h.palette_count; ++i)
            palette.push_back(read_color(reader, h.palette_bits));
    return palette;
}

int channel_count(const Header& h) {
    if (h.color_type() == kGrey) return h.pixel_bits == 16 ? 2 : 1;
    const int bits = h.color_type() == kPalette ? h.palette_bits : h.pixel_bits;
    // The fourth byte means nothing without alpha bits in the descriptor.
    return bits == 32 && h.alpha_bits() > 0 ? 4 : 3;
}

class PixelReader {
  public:
    PixelReader(ByteReader& reader, const Header& header, std::vector<Pixel> palette)
        : reader_(reader), header_(header), palette_(std::move(palette)) {}

    Pixel next() {
        if (!header_.run_length()) return read();
        if (left_ == 0) {
            const int packet = reader_.u8();
            left_ = (packet & 127) + 1;
            repeats_ = packet & 128;
            if (repeats_) repeated_ = read();
        }
        --left_;
        return repeats_ ? repeated_ : read();
    }

  private:
    Pixel read() {
        if (header_.color_type() == kGrey) return read_grey(reader_, header_.pixel_bits);
        if (header_.color_type() == kColor) return read_color(reader_, header_.pixel_bits);
        if (header_.pixel_bits != 8 && header_.pixel_bits != 16)
            throw DecodeError("TGA indices of " + std::to_string(header_.pixel_bits) + " bits");
        const int index =
            (header_.pixel_bits == 8 ? reader_.u8() : reader_.little_u16()) - header_.palette_first;
        if (index < 0 || size_t(index) >= palette_.size())
            throw DecodeError("a colour is missing in its palette");
        return palette_[size_t(index)];
    }

    ByteReader& reader_;
    const Header& header_;
    std::vector<Pixel> palette_;
    Pixel repeated_{};
    int left_ = 0;  ///< pixels of the current packet that are still to come
    bool repeats_ = false;
};

void mirror_columns(PlainImage& image) {
    const size_t width = size_t(image.width), channels = size_t(image.channels);
    for (size_t y = 0; y < size_t(image.height); ++y)
        for (size_t x = 0; x < width / 2; ++x)
            for (size_t c = 0; c < channels; ++c)
                std::swap(image.bytes[(y * width + x) * channels + c],
                          image.bytes[(y * width + width - 1 - x) * channels + c]);
}

}  // namespace

PlainImage decode_targa(Bytes bytes) {
    ByteReader reader(bytes);
    const Header header = read_header(reader);
    reader.take(size_t(header.id_length));
    PlainImage image = make_plain_image(header.width, header.height, channel_count(header), 8);
    PixelReader pixels(reader, header, read_palette(reader, header));
    const size_t count = size_t(image.width) * size_t(image.height);
    for (size_t i = 0; i < count; ++i) {
        const Pixel pixel = pixels.next();
        image.bytes.insert(image.bytes.end(), pixel.begin(), pixel.begin() + image.channels);
    }
    if (!header.from_top()) flip_rows(image);
    if (header.from_right()) mirror_columns(image);
    return image;
}

}  // namespace covtrace
