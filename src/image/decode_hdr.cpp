#include <cmath>
#include <cstdio>
#include <string>

#include "image/byte_reader.h"
#include "image/plain_image.h"

namespace covtrace {

namespace {

std::string read_line(ByteReader& reader) {
    constexpr size_t kLongestLine = 4096;
    std::string line;
    for (char c; (c = char(reader.u8())) != '\n';) {
        if (line.size() == kLongestLine) throw DecodeError("a line of its header has no end");
        line += c;
    }
    return line;
}

struct Rgbe {
    uint8_t r, g, b, e;
};

Rgbe read_rgbe(ByteReader& reader) {
    const Bytes b = reader.take(4);
    return {b[0], b[1], b[2], b[3]};
}

/// Reads a row with new run lengths: the four components one after the other, runs of at most 127.
void read_components(ByteReader& reader, std::vector<Rgbe>& row) {
    for (uint8_t Rgbe::*component : {&Rgbe::r, &Rgbe::g, &Rgbe::b, &Rgbe::e})
        for (size_t x = 0; x < row.size();) {
            const int code = reader.u8();
            const size_t count = code > 128 ? size_t(code - 128) : size_t(code);
            if (count == 0 || count > row.size() - x)
                throw DecodeError("a run is longer than its row");
            const uint8_t repeated = code > 128 ? reader.u8() : uint8_t(0);
            for (size_t end = x + count; x < end; ++x)
                row[x].*component = code > 128 ? repeated : reader.u8();
        }
}

/// Reads a row of flat pixels or old run lengths: (1, 1, 1, n) repeats the pixel before n times;
/// several of them in a row are the digits of a longer run, the lowest first.
void read_pixels(ByteReader& reader, Rgbe first, std::vector<Rgbe>& row) {
    int shift = 0;
    for (size_t x = 0; x < row.size();) {
        const Rgbe pixel = x == 0 && shift == 0 ? first : read_rgbe(reader);
        if (pixel.r == 1 && pixel.g == 1 && pixel.b == 1) {
            const size_t count = shift < 24 ? size_t(pixel.e) << shift : row.size() + 1;
            if (x == 0 || count > row.size() - x) throw DecodeError("a run is longer than its row");
            for (size_t end = x + count; x < end; ++x) row[x] = row[x - 1];
            shift += 8;
        } else {
            row[x++] = pixel;
            shift = 0;
        }
    }
}

void read_row(ByteReader& reader, std::vector<Rgbe>& row) {
    const Rgbe first = read_rgbe(reader);
    const bool by_component =
        first.r == 2 && first.g == 2 && size_t(first.b << 8 | first.e) == row.size();
    if (by_component)
        read_components(reader, row);
    else
        read_pixels(reader, first, row);
}

}  // namespace

PlainImage decode_hdr(Bytes bytes) {
    ByteReader reader(bytes);
    for (std::string line = read_line(reader); !line.empty(); line = read_line(reader))
        if (line.starts_with("FORMAT=") && line != "FORMAT=32-bit_rle_rgbe")
            throw DecodeError("its format is '" + line.substr(7) + "', not 32-bit_rle_rgbe");
    const std::string resolution = read_line(reader);
    char vertical = 0;
    int width = 0, height = 0, end = 0;
    if (std::sscanf(resolution.c_str(), "%cY %8d +X %8d%n", &vertical, &height, &width, &end) !=
            3 ||
        (vertical != '-' && vertical != '+') || size_t(end) != resolution.size())
        throw DecodeError("its resolution '" + resolution + "' is not of the form -Y n +X n");

    PlainImage image = make_plain_image(width, height, 3, 0);
    std::vector<Rgbe> row(size_t(width), Rgbe{});
    for (int y = 0; y < height; ++y) {
        read_row(reader, row);
        for (const Rgbe& p : row) {
            const float scale = p.e == 0 ? 0.0f : std::ldexp(1.0f, int(p.e) - (128 + 8));
            image.values.insert(image.values.end(), {p.r * scale, p.g * scale, p.b * scale});
        }
    }
    if (vertical == '+') flip_rows(image);
    return image;
}

}  // namespace covtrace
