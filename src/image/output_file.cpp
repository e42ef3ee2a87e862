#include "image/output_file.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <utility>

#include "core/error.h"
#include "core/file_kind.h"

namespace covtrace {

namespace {

constexpr const char* kPartSuffix = ".part-";
constexpr size_t kBufferSize = size_t(1) << 18;

std::filesystem::path directory_of(const std::filesystem::path& file) {
    return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

std::string host_name() {
    char name[256] = {};
    if (::gethostname(name, sizeof name - 1) != 0 || !*name) return "localhost";
    std::string host = name;
    std::replace(host.begin(), host.end(), '/', '_');
    return host;
}

/// Whether a file is special: a device, a pipe, a socket.
bool is_special(const std::filesystem::path& file) {
    struct stat status {};
    return ::stat(file.c_str(), &status) == 0 && !S_ISREG(status.st_mode) &&
           !S_ISDIR(status.st_mode);
}

/// The descriptor that /dev/stdout, /dev/stderr or /dev/fd/N names; -1 for other files. A shell
/// that sends standard output to a file goes on writing there: that file is no name to be replaced.
int open_descriptor(const std::filesystem::path& file) {
    std::filesystem::path name = file;
    std::error_code error;
    if (name == "/dev/stdout" || name == "/dev/stderr")
        name = std::filesystem::read_symlink(name, error);
    const std::string number = name.filename().string();
    if (error || number.empty() || number.find_first_not_of("0123456789") != std::string::npos ||
        !std::filesystem::equivalent(directory_of(name), "/proc/self/fd", error))
        return -1;
    return int(std::strtol(number.c_str(), nullptr, 10));
}

}  // namespace

bool OutputFile::names_stream(const std::filesystem::path& target) {
    return open_descriptor(target) >= 0 || is_special(target);
}

std::filesystem::path OutputFile::resolved(const std::filesystem::path& target) {
    // Streams keep their names: links of /proc lead to things that have none.
    if (names_stream(target)) return target;
    // Links are followed one by one: a link to a file that is not there yet, or no longer, is one
    // all the same.
    constexpr int kMostLinks = 40;  // as the system allows
    std::filesystem::path file = target;
    std::error_code error;
    for (int k = 0; k < kMostLinks; ++k) {
        if (!std::filesystem::is_symlink(file, error)) return file;
        const std::filesystem::path leads_to = std::filesystem::read_symlink(file, error);
        if (error) return target;
        file = directory_of(file) / leads_to;
    }
    return target;
}

std::string OutputFile::part_suffix() {
    return kPartSuffix + host_name() + "-" + std::to_string(::getpid());
}

bool OutputFile::is_leftover(const std::string& name, const std::string& target) {
    const std::string start = target + kPartSuffix + host_name() + "-";
    if (!name.starts_with(start)) return false;
    const long process = std::strtol(name.c_str() + start.size(), nullptr, 10);
    return process > 0 && ::kill(pid_t(process), 0) != 0 && errno == ESRCH;
}

OutputFile::OutputFile(std::filesystem::path target)
    : target_(std::move(target)), final_(resolved(target_)) {
    std::error_code ignored;
    struct stat status {};
    const bool exists = ::stat(final_.c_str(), &status) == 0;
    if (exists && S_ISDIR(status.st_mode)) fail(EISDIR);
    std::filesystem::path opened = final_;
    int flags = O_WRONLY | O_CLOEXEC;
    const int open_already = open_descriptor(final_);
    // Opening a pipe waits until somebody reads it, which may be never.
    if (exists && open_already < 0 && (S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode)))
        throw Error(ErrorKind::usage, "cannot write '" + target_.string() + "': it is " +
                                          irregular_kind(final_) +
                                          "; expected a regular file, or /dev/stdout");
    if (open_already < 0 && (!exists || S_ISREG(status.st_mode))) {
        temporary_ = final_;
        temporary_ += part_suffix();
        opened = temporary_;
        flags |= O_CREAT | O_TRUNC;
    }
    descriptor_ = open_already >= 0 ? ::fcntl(open_already, F_DUPFD_CLOEXEC, 0)
                                    : ::open(opened.c_str(), flags, 0666);
    if (descriptor_ < 0) {
        const int error_number = errno;
        temporary_.clear();
        const auto directory = directory_of(final_);
        if (error_number == ENOENT && !std::filesystem::exists(directory, ignored))
            throw Error(ErrorKind::io, "cannot write '" + target_.string() + "': the directory '" +
                                           directory.string() + "' does not exist");
        fail(error_number);
    }
    if (exists && !temporary_.empty()) {
        // The result does not matter: where permissions cannot be carried over, the file is still
        // right.
        [[maybe_unused]] const int result = ::fchmod(descriptor_, status.st_mode & 07777);
    }
    buffer_.reserve(kBufferSize);
}

OutputFile::~OutputFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void OutputFile::write(const void* bytes, size_t count) {
    if (is_stream()) {
        buffer_.resize(std::max(buffer_.size(), size_t(position_) + count));
        std::memcpy(buffer_.data() + position_, bytes, count);
        position_ += count;
        return;
    }
    buffer_.append(static_cast<const char*>(bytes), count);
    position_ += count;
    if (buffer_.size() >= kBufferSize) flush();
}

void OutputFile::seek(uint64_t position) {
    if (position == position_) return;
    if (is_stream()) {
        position_ = position;
        return;
    }
    flush();
    if (::lseek(descriptor_, off_t(position), SEEK_SET) < 0) fail(errno);
    position_ = position;
}

void OutputFile::flush() {
    const char* next = buffer_.data();
    size_t left = buffer_.size();
    while (left > 0) {
        const ssize_t written = ::write(descriptor_, next, left);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) fail(errno);
        if (written == 0) fail(ENOSPC);
        next += written;
        left -= size_t(written);
    }
    buffer_.clear();
}

void OutputFile::keep_older(const std::filesystem::path& earlier) {
    // The older file gets a second name first, which then takes the place of the one before it.
    // Where the file system knows no second names, the older file itself is moved: programs that
    // look for it must look for `earlier`, too.
    std::filesystem::path second = earlier;
    second += part_suffix();
    ::unlink(second.c_str());
    if (::link(final_.c_str(), second.c_str()) == 0) {
        const bool renamed = ::rename(second.c_str(), earlier.c_str()) == 0;
        // Renaming leaves the second name where both are names of one file, as after a process that
        // was killed here.
        if (renamed) {
            ::unlink(second.c_str());
            return;
        }
        const int error_number = errno;
        ::unlink(second.c_str());
        fail(error_number);
    }
    if (errno == ENOENT) return;
    if (::rename(final_.c_str(), earlier.c_str()) != 0) fail(errno);
}

void OutputFile::commit(const std::filesystem::path& earlier) {
    // A caller may have lost the exception of an earlier failure, as OpenEXR's destructors do.
    if (error_ != 0) fail(error_);
    flush();
    // Devices and pipes cannot be synchronised and say so with EINVAL.
    if (::fsync(descriptor_) != 0 && errno != EINVAL) fail(errno);
    const int descriptor = std::exchange(descriptor_, -1);
    if (::close(descriptor) != 0) fail(errno);
    if (temporary_.empty()) return;
    if (!earlier.empty()) keep_older(earlier);
    if (::rename(temporary_.c_str(), final_.c_str()) != 0) fail(errno);
    temporary_.clear();
    // Syncing the directory makes the new name last through a power cut; file systems that cannot
    // do it lose nothing else.
    const int directory = ::open(directory_of(final_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (directory >= 0) {
        ::fsync(directory);
        ::close(directory);
    }
}

void OutputFile::fail(int error_number) {
    if (error_ == 0) error_ = error_number;
    throw Error(ErrorKind::io, "cannot write '" + target_.string() +
                                   "': " + std::generic_category().message(error_number));
}

}  // namespace covtrace
