/// Shared libraries of which the end is missing.
#pragma once

#include <filesystem>

namespace covtrace {

/// Throws Error(usage) where `file` cannot be read, or is shorter than what its own headers say is
/// loaded from it: the dynamic linker would map what is not there, and the process would end by a
/// signal. What is no 64-bit ELF file at all is left to the linker, which refuses it.
void require_whole(const std::filesystem::path& file);

}  // namespace covtrace
