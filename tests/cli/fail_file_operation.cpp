// Preloaded into the program by test_file_failures.py and test_killed_writers.py: lets one operation
// on a file that is being written fail or end the program, or every write be short.
//   COVTRACE_FAIL_AT=n         the n-th operation fails with EIO (a write with ENOSPC), from 0
//   COVTRACE_KILL_AT=n         the process is killed before the n-th operation, or half-way through
//                              it if it is a write
//   COVTRACE_FAIL_LIST=FILE    the names of all operations go there, a line each
//   COVTRACE_SHORT_WRITES=1    each write takes at most 1000 bytes
#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>

namespace {

std::atomic<long> operations{0};

long number(const char* variable) {
    const char* value = std::getenv(variable);
    return value ? std::atol(value) : -1;
}

[[noreturn]] void die() {
    kill(getpid(), SIGKILL);
    for (;;) pause();
}

std::atomic<bool> written[1024];  // by descriptor: opened for writing
std::atomic<bool> filled[1024];  // by descriptor: written to, too; only then does closing it matter

template <typename Function>
Function next(const char* name) {
    return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

bool fails(const char* operation) {
    if (const char* file = std::getenv("COVTRACE_FAIL_LIST"))
        if (std::FILE* out = std::fopen(file, "a")) {
            std::fprintf(out, "%s\n", operation);
            std::fclose(out);
        }
    if (operations == number("COVTRACE_KILL_AT")) die();
    return operations++ == number("COVTRACE_FAIL_AT");
}

int failure(int error) {
    errno = error;
    return -1;
}

bool is_written(int descriptor) {
    return descriptor >= 0 && descriptor < 1024 && written[descriptor];
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
    va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = va_arg(arguments, mode_t);
    va_end(arguments);
    const bool writes = (flags & O_ACCMODE) != O_RDONLY && (flags & O_CREAT);
    if (writes && fails("open")) return failure(EIO);
    const int descriptor = next<int (*)(const char*, int, ...)>("open")(path, flags, mode);
    if (descriptor >= 0 && descriptor < 1024) {
        written[descriptor] = writes;
        filled[descriptor] = false;
    }
    return descriptor;
}

ssize_t write(int descriptor, const void* bytes, size_t count) {
    if (is_written(descriptor)) {
        if (operations == number("COVTRACE_KILL_AT"))
            next<ssize_t (*)(int, const void*, size_t)>("write")(descriptor, bytes, count / 2);
        if (fails("write")) return failure(ENOSPC);
        filled[descriptor] = true;
        if (std::getenv("COVTRACE_SHORT_WRITES")) count = std::min<size_t>(count, 1000);
    }
    return next<ssize_t (*)(int, const void*, size_t)>("write")(descriptor, bytes, count);
}

int fsync(int descriptor) {
    if (is_written(descriptor) && fails("fsync")) return failure(EIO);
    return next<int (*)(int)>("fsync")(descriptor);
}

int close(int descriptor) {
    const bool failing = is_written(descriptor) && filled[descriptor] && fails("close");
    if (descriptor >= 0 && descriptor < 1024) written[descriptor] = false;
    const int result = next<int (*)(int)>("close")(descriptor);
    return failing ? failure(EIO) : result;
}

int rename(const char* from, const char* to) {
    if (fails("rename")) return failure(EIO);
    return next<int (*)(const char*, const char*)>("rename")(from, to);
}

int link(const char* from, const char* to) {
    if (fails("link")) return failure(EIO);
    return next<int (*)(const char*, const char*)>("link")(from, to);
}

int unlink(const char* path) {
    if (fails("unlink")) return failure(EIO);
    return next<int (*)(const char*)>("unlink")(path);
}

}  // extern "C"
