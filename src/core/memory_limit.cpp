#include "core/memory_limit.h"

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <limits>

namespace covtrace {
namespace {

constexpr size_t kNone = std::numeric_limits<size_t>::max();
std::atomic<size_t> most_bytes{kNone}, reserved_bytes{0};

std::string megabytes(size_t bytes) {
    char text[32];
    std::snprintf(text, sizeof text, "%.0fM", double(bytes) / double(1 << 20));
    return text;
}

size_t machine_bytes() {
    const long pages = sysconf(_SC_PHYS_PAGES);
    return pages > 0 ? size_t(pages) * size_t(sysconf(_SC_PAGE_SIZE)) : kNone;
}

/// Whether `bytes` more stay within `most`, together with the memory that is held and reserved.
bool fits(size_t bytes, size_t most) {
    const size_t held = resident_bytes() + reserved_bytes.load();
    return held <= most && bytes <= most - held;
}

}  // namespace

size_t resident_bytes() {
    size_t pages = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> pages >> resident;
    return resident * size_t(sysconf(_SC_PAGE_SIZE));
}

void return_freed_memory() {
    malloc_trim(0);
}

MemoryLimit::MemoryLimit(size_t most) {
    most_bytes = most;
}
MemoryLimit::~MemoryLimit() {
    most_bytes = kNone;
}

MemoryReservation::MemoryReservation(size_t bytes, const std::string& what,
                                     const SourceLocation& where) {
    // Small amounts are not worth a look at the system's books.
    constexpr size_t kLittle = size_t{1} << 20;
    const size_t own = most_bytes.load(), most = std::min(own, machine_bytes());
    if (bytes > kLittle && !fits(bytes, most)) {
        return_freed_memory();
        if (!fits(bytes, most))
            throw Error(ErrorKind::limit, where,
                        what + " need " + megabytes(bytes) + " beside the " +
                            megabytes(resident_bytes()) + " that are in memory, more than " +
                            (own <= most ? "the limit of " : "the machine's ") + megabytes(most));
    }
    bytes_ = bytes;
    reserved_bytes += bytes;
}
MemoryReservation::~MemoryReservation() {
    reserved_bytes -= bytes_;
}

}  // namespace covtrace
