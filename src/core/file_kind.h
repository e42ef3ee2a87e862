/// Names that stand for something else than a file with bytes of its own.
#pragma once

#include <filesystem>
#include <string>

namespace covtrace {

/// The kind of thing that stands in the place of a regular file, links followed: "a folder", "a
/// named pipe", "a socket", "a device". Empty for regular files and where there is nothing. Opening
/// a pipe would wait for its other side, so readers and writers ask this first.
std::string irregular_kind(const std::filesystem::path& file);

}  // namespace covtrace
