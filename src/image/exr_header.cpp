#include "image/exr_header.h"

#include <cstdint>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "image/plain_image.h"

namespace covtrace {
namespace {

constexpr size_t kLongestName = 255;  // in bytes; of OpenEXR 2.0 and later

/// Bytes of the types whose values OpenEXR reads at their own length, whatever the attribute
/// claims.
const std::map<std::string_view, uint32_t> kSizes{{"box2f", 16},
                                                  {"box2i", 16},
                                                  {"chromaticities", 32},
                                                  {"compression", 1},
                                                  {"deepImageState", 1},
                                                  {"double", 8},
                                                  {"envmap", 1},
                                                  {"float", 4},
                                                  {"int", 4},
                                                  {"keycode", 28},
                                                  {"lineOrder", 1},
                                                  {"m33d", 72},
                                                  {"m33f", 36},
                                                  {"m44d", 128},
                                                  {"m44f", 64},
                                                  {"rational", 8},
                                                  {"tiledesc", 9},
                                                  {"timecode", 8},
                                                  {"v2d", 16},
                                                  {"v2f", 8},
                                                  {"v2i", 8},
                                                  {"v3d", 24},
                                                  {"v3f", 12},
                                                  {"v3i", 12}};

/// Reads a name up to its zero byte; empty where that does not come.
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

/// Whether a list of channels ends where its attribute does: OpenEXR reads on to the empty name.
bool is_channel_list(std::string_view value) {
    constexpr size_t kRest = 16;  // bytes of a channel after its name
    while (!value.empty() && value[0] != '\0') {
        const size_t name = value.find('\0');
        if (name == value.npos || value.size() - name - 1 < kRest) return false;
        value.remove_prefix(name + 1 + kRest);
    }
    return value.size() == 1;
}

/// Whether each string of a list ends within it.
bool is_string_list(std::string_view value) {
    while (!value.empty()) {
        if (value.size() < 4) return false;
        uint32_t size = 0;
        for (size_t i = 4; i-- > 0;) size = size << 8 | uint8_t(value[i]);
        if (size > value.size() - 4) return false;
        value.remove_prefix(4 + size);
    }
    return true;
}

/// Whether a picture has the size that its first eight bytes say.
bool is_preview(std::string_view value) {
    if (value.size() < 8) return false;
    uint64_t side[2] = {};
    for (size_t k = 0; k < 2; ++k)
        for (size_t i = 4; i-- > 0;) side[k] = side[k] << 8 | uint8_t(value[4 * k + i]);
    return side[0] < (1 << 20) && side[1] < (1 << 20) && 4 * side[0] * side[1] == value.size() - 8;
}

bool is_sound(const std::string& type, std::string_view value) {
    if (type == "chlist") return is_channel_list(value);
    if (type == "stringvector") return is_string_list(value);
    if (type == "preview") return is_preview(value);
    const auto known = kSizes.find(type);
    return known == kSizes.end() || known->second == value.size();
}

}  // namespace

// The layout is described at https://openexr.com/en/latest/OpenEXRFileLayout.html: magic number and
// version, then for each part the name, type, size and value of its attributes and an empty name;
// after the headers of several parts one more empty name.
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
        const std::optional<std::string> type = read_name(in);
        if (!type) return;
        const std::optional<uint32_t> size = read_u32(in);
        if (!size) return;
        if (*size > length - uint64_t(in.tellg()))
            throw DecodeError("the attribute '" + *name + "' claims to be longer than the file");
        std::string value(*size, '\0');
        in.read(value.data(), std::streamsize(*size));
        if (!is_sound(*type, value))
            throw DecodeError("the attribute '" + *name + "' has another size than its value");
    }
}

}  // namespace covtrace
