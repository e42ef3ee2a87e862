/// The header of a PLY file: which elements follow and which properties each has.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"

namespace covtrace {

enum class PlyNumber : uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
size_t size_of(PlyNumber type);

struct PlyProperty {
    std::string name;
    PlyNumber type{};
    bool is_list = false;
    PlyNumber count_type{};  ///< type of a list's length
};
struct PlyElement {
    std::string name;
    uint64_t count = 0;
    std::vector<PlyProperty> properties;
    SourceLocation where;
    /// The fewest bytes (binary) or characters (ascii) that one such element takes.
    uint64_t smallest_size(bool ascii) const;
};
struct PlyHeader {
    enum class Format { ascii, little_endian, big_endian };
    Format format{};
    std::vector<PlyElement> elements;
    size_t size = 0;  ///< bytes up to the data
    int lines = 0;
};

/// Reads the header at the beginning of a file. Errors: Error(scene) with line and column.
PlyHeader read_ply_header(std::string_view bytes, const std::shared_ptr<const std::string>& file);

}  // namespace covtrace
