#include "image/exr_header.h"

#include <cstdint>
#include <fstream>
#include <optional>
#include <string>

#include "image/plain_image.h"

namespace covtrace {
namespace {

constexpr size_t kLongestName = 255;  // of OpenEXR 2.0 and later

/// Up to a zero byte; none where that does not come.
std::optional<std::string> read_name(std::istream& in) {
    std::string name;
    for (char c = 0; in.get(c);) {
        if (c == '\0') return name;
        if (name.size() == kLongestName) break;
        name += c;
    }
    return {};
}

std::optional<uint32_t> read_u32(std::istream& in) {
    unsigned char b[4] = {};
    if (!in.read(reinterpret_cast<char*>(b), sizeof b)) return {};
    return uint32_t(b[0]) | uint32_t(b[1]) << 8 | uint32_t(b[2]) << 16 | uint32_t(b[3]) << 24;
}

}  // namespace

// https://openexr.com/en/latest/OpenEXRFileLayout.html: magic number and version, then per part
// name, type, size and value of its attributes and an empty name; after the headers of several
// parts one more empty name.
void check_exr_attribute_sizes(const std::filesystem::path& file) {
    const uint64_t length = std::filesystem::file_size(file);
    std::ifstream in(file, std::ios::binary);
    read_u32(in);
    const std::optional<uint32_t> version = read_u32(in);
    if (!version) return;
    const bool has_parts = (*version & 0x1000) != 0;
    for (bool is_begun = false;;) {
        const std::optional<std::string> name = read_name(in);
        if (!name) return;
        if (name->empty()) {
            if (!has_parts || !is_begun) return;
            is_begun = false;
            continue;
        }
        is_begun = true;
        if (!read_name(in)) return;
        const std::optional<uint32_t> size = read_u32(in);
        if (!size) return;
        if (*size > length - uint64_t(in.tellg()))
            throw DecodeError("the attribute '" + *name + "' claims to be longer than the file");
        in.seekg(std::streamoff(*size), std::ios::cur);
    }
}

}  // namespace covtrace
