/// Checks for files that a command would lose because two of its names are one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace covtrace::cli {

/// Whether both names are one regular file, there already or not, however they are spelled:
/// relative or not, through links of any kind, in another case where the file system ignores it.
/// Devices, pipes and empty names are never one.
bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// An output: the option that asks for it ("--png") and its name, which is empty where it is not
/// asked for.
struct NamedOutput {
    std::string option;
    std::filesystem::path file;
};

/// Throws Error(usage) where two outputs are one file, or where an output would take the place of
/// an input.
void require_distinct(const std::vector<NamedOutput>& outputs,
                      const std::vector<std::filesystem::path>& inputs);

/// Adds a film and the name under which the film that it replaces lives on.
void add_film(std::vector<NamedOutput>& outputs, const std::string& option,
              const std::filesystem::path& film);

}  // namespace covtrace::cli
