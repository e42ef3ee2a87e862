/// Private to this folder: what OpenEXR believes of a header without looking.
#pragma once

#include <filesystem>

namespace covtrace {

/// Throws DecodeError where an attribute of a header claims more bytes than the file has left, or
/// another number than its value takes: OpenEXR allocates what a string claims before it reads it,
/// and reads values at their own length, so that what follows would be taken for other attributes
/// than it is here. Anything else that is wrong is left to OpenEXR.
void check_exr_attribute_sizes(const std::filesystem::path& file);

}  // namespace covtrace
