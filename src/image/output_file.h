/// A file that appears whole or not at all: written under another name in the same directory,
/// flushed to the disk and renamed over its target by commit().
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace covtrace {

/// Until commit() returns, an older file of the target's name stays as it was; without commit() the
/// destructor removes what was written. A symbolic link is followed, so that it still is one
/// afterwards. A target that exists and is no regular file (/dev/null, a pipe) is written directly.
///
/// All functions throw Error(io) that names the target and the reason of the system.
class OutputFile {
  public:
    static constexpr const char* kPartSuffix = ".part-";
    /// Creates the temporary file, target + ".part-<process id>". Constructing and dropping one
    /// therefore tells early whether the target can be written.
    explicit OutputFile(std::filesystem::path target);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    void write(const void* bytes, size_t count);
    uint64_t position() const { return position_; }
    void seek(uint64_t position);
    /// `earlier`: the name under which an older file of the target's name lives on. There is no
    /// moment without a file of the target's name.
    void commit(const std::filesystem::path& earlier = {});
    const std::filesystem::path& target() const { return target_; }

  private:
    [[noreturn]] void fail(int error_number);
    void flush();
    void keep_older(const std::filesystem::path& earlier);

    std::filesystem::path target_;     ///< as the caller named it
    std::filesystem::path final_;      ///< links resolved
    std::filesystem::path temporary_;  ///< empty where the target is written directly
    std::string buffer_;
    uint64_t position_ = 0;
    int descriptor_ = -1;
    int error_ = 0;  ///< of the first failure: nothing can be committed after one
};

}  // namespace covtrace
