/// The input of a fuzz target as a file, for readers that want one.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

namespace covtrace {

/// An input file, overwritten each time and gone when the process ends.
class InputFile {
  public:
    explicit InputFile(const std::string& suffix)
        : path_(std::filesystem::temp_directory_path() /
                ("covtrace-fuzz-" + std::to_string(getpid()) + suffix)) {}
    ~InputFile() { std::filesystem::remove(path_); }
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;

    const std::filesystem::path& write(const uint8_t* data, size_t size) const {
        std::ofstream(path_, std::ios::binary)
            .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
        return path_;
    }

  private:
    std::filesystem::path path_;
};

}  // namespace covtrace
