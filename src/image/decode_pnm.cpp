#include <bit>
#include <charconv>
#include <cmath>
#include <string>

#include "image/byte_reader.h"
#include "image/plain_image.h"

namespace covtrace {

namespace {

bool is_space(uint8_t c) {
    return c == ' ' || (c >= '\t' && c <= '\r');
}

/// The next word of the header and the one white space behind it; comments are skipped.
std::string read_word(ByteReader& reader) {
    constexpr size_t kLongestWord = 64;
    uint8_t c = reader.u8();
    while (is_space(c) || c == '#') {
        if (c == '#')
            while (c != '\n') c = reader.u8();
        c = reader.u8();
    }
    std::string word;
    for (; !is_space(c); c = reader.u8()) {
        if (word.size() == kLongestWord) throw DecodeError("its header is damaged");
        word += char(c);
    }
    return word;
}

template <class Number>
Number read_number(ByteReader& reader) {
    const std::string word = read_word(reader);
    Number number{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size())
        throw DecodeError("its header has '" + word + "' in place of a number");
    return number;
}

PlainImage decode_floats(ByteReader& reader, int channels) {
    const int width = read_number<int>(reader), height = read_number<int>(reader);
    const float scale = read_number<float>(reader);
    if (!std::isfinite(scale) || scale == 0) throw DecodeError("its scale is not a number above 0");
    PlainImage image = make_plain_image(width, height, channels, 0);
    const size_t count = size_t(width) * size_t(height) * size_t(channels);
    for (size_t i = 0; i < count; ++i) {
        const uint32_t bits = scale < 0 ? reader.little_u32() : reader.big_u32();
        const float value = std::bit_cast<float>(bits);
        image.values.push_back(std::abs(scale) == 1 ? value : value * std::abs(scale));
    }
    flip_rows(image);
    return image;
}

PlainImage decode_integers(ByteReader& reader, int channels) {
    const int width = read_number<int>(reader), height = read_number<int>(reader);
    const int largest = read_number<int>(reader);
    if (largest < 1 || largest > 65535) throw DecodeError("its largest value is not in 1 … 65535");
    const bool bytes = largest < 256;
    // Values of other ranges than 0 to 255 become 16-bit ones, so that each step is kept exactly.
    PlainImage image = make_plain_image(width, height, channels, largest == 255 ? 8 : 16);
    const size_t count = size_t(width) * size_t(height) * size_t(channels);
    if (image.is_8bit()) {
        const Bytes all = reader.rest().first(std::min(count, reader.rest().size()));
        image.bytes.assign(all.begin(), all.end());
        reader.take(count);
        return image;
    }
    for (size_t i = 0; i < count; ++i) {
        const int value = bytes ? reader.u8() : reader.big_u16();
        image.values.push_back(std::min(1.0f, float(value) / float(largest)));
    }
    return image;
}

}  // namespace

PlainImage decode_pnm(Bytes bytes) {
    ByteReader reader(bytes);
    const std::string magic = read_word(reader);
    if (magic == "PF") return decode_floats(reader, 3);
    if (magic == "Pf") return decode_floats(reader, 1);
    if (magic == "P6") return decode_integers(reader, 3);
    if (magic == "P5") return decode_integers(reader, 1);
    throw DecodeError("the variant " + magic + " of PNM is not supported, only PF, Pf, P5 and P6");
}

}  // namespace covtrace
