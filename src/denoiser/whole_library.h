/// A check for shared libraries whose end is missing.
#pragma once

#include <filesystem>

namespace covtrace {

/// Throws Error(usage) where `file` cannot be read, or is shorter than its own headers say: the
/// dynamic linker would map pages that are not there, and the process would end by a signal. A file
/// that is no 64-bit ELF file at all is left to the linker, which refuses it.
void require_whole(const std::filesystem::path& file);

}  // namespace covtrace
