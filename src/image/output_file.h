/// A file that appears whole or not at all: written under another name in the same directory,
/// flushed to the disk and renamed over its target by commit().
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace covtrace {

/// An output file. Until commit() returns, an older file of the target's name stays as it was;
/// without commit() the destructor removes what was written. A symbolic link is followed, so that
/// it still is one afterwards. A device (/dev/null) and the streams behind /dev/stdout or /dev/fd/N
/// get all bytes in commit(), after what is there.
///
/// All functions throw Error(io) that names the target and the reason of the system; the
/// constructor Error(usage) for named pipes and sockets, which may never be read.
class OutputFile {
  public:
    /// Whether a target is a device or a stream, as /dev/stdout, and not a file that is replaced.
    static bool names_stream(const std::filesystem::path& target);
    /// The file that a target stands for: the target of a symbolic link, or the name itself.
    static std::filesystem::path resolved(const std::filesystem::path& target);
    /// Ending of temporary files' names, after the target's: ".part-<host>-<process id>", so that
    /// machines that share a folder know theirs.
    static std::string part_suffix();
    /// Whether a name that begins with `target`'s, links resolved, is that of a temporary file
    /// whose process, of this host, is no more.
    static bool is_leftover(const std::string& name, const std::string& target);
    /// Creates the temporary file. Constructing and dropping one therefore tells early whether the
    /// target can be written.
    explicit OutputFile(std::filesystem::path target);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    void write(const void* bytes, size_t count);
    uint64_t position() const { return position_; }
    void seek(uint64_t position);
    /// Puts the file in the target's place. `earlier`: the name under which an older file of the
    /// target's name lives on, on the file system of resolved(target). There is no moment without a
    /// file of the target's name, unless the file system has no hard links: there the older one is
    /// moved before the newer one takes its place.
    void commit(const std::filesystem::path& earlier = {});
    const std::filesystem::path& target() const { return target_; }

  private:
    [[noreturn]] void fail(int error_number);
    void flush();
    /// Whether the target is a stream, which can't be sought in: `buffer_` holds all of it.
    bool is_stream() const { return temporary_.empty(); }
    void keep_older(const std::filesystem::path& earlier);

    std::filesystem::path target_;     ///< as the caller named it
    std::filesystem::path final_;      ///< links resolved
    std::filesystem::path temporary_;  ///< empty where the target is written directly
    std::string buffer_;
    uint64_t position_ = 0;
    int descriptor_ = -1;
    int error_ = 0;  ///< error number of the first failure, after which nothing can be committed
};

}  // namespace covtrace
