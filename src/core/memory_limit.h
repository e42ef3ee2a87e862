/// Bound on the memory that the process may hold: asked before room is made for what a file claims
/// to be.
///
/// The limit belongs to the process, as the memory does, and is no parameter of readers: files are
/// read far below the functions that know of it.
#pragma once

#include <cstddef>
#include <string>
#include <utility>

#include "core/error.h"

namespace covtrace {

/// Bytes of the process that are in memory now; 0 where the system does not tell.
size_t resident_bytes();

/// Gives back to the system the memory that was freed: thousands of small pieces (the text of a
/// scene, its parameters) otherwise count as held for as long as the process lives.
void return_freed_memory();

/// A limit in force while it lives: the process shall hold at most `most` bytes. Without one the
/// bound is the machine's memory. One at a time.
class MemoryLimit {
  public:
    explicit MemoryLimit(size_t most);
    ~MemoryLimit();
    MemoryLimit(const MemoryLimit&) = delete;
    MemoryLimit& operator=(const MemoryLimit&) = delete;
};

/// Memory that is about to be filled; while the reservation lives its bytes count as held.
class MemoryReservation {
  public:
    MemoryReservation() = default;
    /// Throws Error(limit) at `where` with one line that begins with `what` ("16384x16384 pixels")
    /// and names the bytes and the limit, where they are more than is left.
    MemoryReservation(size_t bytes, const std::string& what, const SourceLocation& where = {});
    ~MemoryReservation();
    MemoryReservation(MemoryReservation&& other) noexcept
        : bytes_(std::exchange(other.bytes_, 0)) {}
    MemoryReservation& operator=(MemoryReservation&& other) noexcept {
        std::swap(bytes_, other.bytes_);
        return *this;
    }

  private:
    size_t bytes_ = 0;
};

}  // namespace covtrace
