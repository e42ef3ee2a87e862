/// The image of a light as radiances.
#pragma once

#include <filesystem>
#include <vector>

#include "core/error.h"
#include "core/vec.h"

namespace covtrace {

struct LightTexels {
    int width = 0, height = 0;
    std::vector<Rgb> values;  ///< linear, row by row from the top; nothing is negative
};

/// Whether the channels of a light's image make a colour.
enum class LightChannels {
    colour,  ///< linear Rec.709, from the colour space that the file names
    factors  ///< as they are
};

/// Integers are decoded from sRGB, as in pbrt-v4; values above `brightest` are cut. Throws
/// Error(scene) at `where` for files that can't be read; warns where a file's colour space is not
/// known.
LightTexels read_light_texels(const std::filesystem::path& file, LightChannels channels,
                              float brightest, const SourceLocation& where, Warnings& warnings);

}  // namespace covtrace
