// Radiance pictures: three mantissas of 8 bits and a common exponent, a value being
// mantissa 2^(exponent - 136). Source: G. Ward, "Real Pixels", Graphics Gems II (1991).
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "image/output_file.h"
#include "image/root_colour.h"
#include "image/write_image.h"

namespace covtrace {

namespace {

constexpr int kBias = 136;
using Rgbe = std::array<uint8_t, 4>;

/// A colour as RGBE, its mantissas rounded to the nearest, so that no picture becomes darker.
Rgbe encoded(std::array<float, 3> rgb) {
    // Values are cut to the largest of the format; comparisons are false for NaN, which becomes 0.
    const float most = std::ldexp(255.0f, 255 - kBias);
    for (float& v : rgb) v = v > 0 ? std::min(v, most) : 0;
    const float largest = std::max({rgb[0], rgb[1], rgb[2]});
    int exponent = 0;
    std::frexp(largest, &exponent);  // largest = m 2^exponent, m in [0.5, 1)
    exponent += kBias - 8;
    if (std::round(std::ldexp(largest, kBias - exponent)) > 255) ++exponent;
    if (!(largest > 0) || exponent < 1) return {};
    Rgbe pixel{0, 0, 0, uint8_t(exponent)};
    for (size_t c = 0; c < 3; ++c)
        pixel[c] = uint8_t(std::round(std::ldexp(rgb[c], kBias - exponent)));
    return pixel;
}

/// Appends one component of a row: 128 + n and a byte that stands n times, or n and n bytes.
void append_runs(std::string& out, const std::vector<Rgbe>& row, size_t component) {
    constexpr size_t kShortestRun = 4, kLongestRun = 127, kMostLiterals = 128;
    const auto run_at = [&](size_t x) {
        size_t n = 1;
        while (n < kLongestRun && x + n < row.size() && row[x + n][component] == row[x][component])
            ++n;
        return n;
    };
    for (size_t x = 0; x < row.size();) {
        size_t run = run_at(x);
        if (run >= kShortestRun) {
            out += char(128 + run);
            out += char(row[x][component]);
            x += run;
            continue;
        }
        const size_t first = x;
        while (x < row.size() && x - first < kMostLiterals && run < kShortestRun)
            if (++x < row.size()) run = run_at(x);
        out += char(x - first);
        for (size_t i = first; i < x; ++i) out += char(row[i][component]);
    }
}

}  // namespace

void write_hdr(const Image& image, const std::filesystem::path& file) {
    const RootColour colour = root_colour(image, file);
    const auto width = size_t(image.width());
    OutputFile output(file);
    // The primaries must be given: without them Radiance has others than Rec.709.
    std::string text =
        "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n"
        "PRIMARIES=0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329\n\n-Y " +
        std::to_string(image.height()) + " +X " + std::to_string(width) + "\n";
    // Run lengths are for these widths only: in others, readers cannot tell them from pixels.
    const bool has_runs = width >= 8 && width < 32768;
    std::vector<Rgbe> row(width);
    for (size_t y = 0; y < size_t(image.height()); ++y) {
        for (size_t x = 0; x < width; ++x) {
            const size_t i = y * width + x;
            row[x] = encoded({colour.channels[0]->values[i], colour.channels[1]->values[i],
                              colour.channels[2]->values[i]});
        }
        if (has_runs) {
            text += {char(2), char(2), char(width >> 8), char(width & 255)};
            for (size_t component = 0; component < 4; ++component)
                append_runs(text, row, component);
        } else {
            for (const Rgbe& pixel : row) text.append(pixel.begin(), pixel.end());
        }
        output.write(text.data(), text.size());
        text.clear();
    }
    output.commit();
}

}  // namespace covtrace
