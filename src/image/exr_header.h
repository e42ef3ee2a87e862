/// Private to this folder: checks on an EXR header's sizes, which OpenEXR believes without looking.
#pragma once

#include <filesystem>

namespace covtrace {

/// Throws DecodeError where an attribute of a header claims more bytes than the file has left, or
/// another number than its value takes. OpenEXR allocates what a string claims before it reads it,
/// and reads values at their own length: it would then take other bytes for the next attributes
/// than this check has seen. Any other fault is left to OpenEXR.
void check_exr_attribute_sizes(const std::filesystem::path& file);

}  // namespace covtrace
