/// Texels that do not fit into memory: in a temporary file, read page by page as they are needed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace covtrace {

/// A file of pages of at most kPageBytes each, of which a bounded number is held in memory. The
/// bytes that are read do not depend on which pages are held, and so neither on time nor on
/// threads.
///
/// The file lies in the folder that the environment variable TMPDIR names, or in /var/tmp, which
/// unlike /tmp is on a disk everywhere. It has no name, so that nothing remains of it however the
/// process ends. All functions throw Error(io) that names the folder and the reason of the system.
class TexelPages {
  public:
    static constexpr size_t kPageBytes = size_t(1) << 14;

    /// Makes an empty file. Pages held in memory take at most `most_bytes`, or one page.
    explicit TexelPages(size_t most_bytes);
    ~TexelPages();
    TexelPages(const TexelPages&) = delete;
    TexelPages& operator=(const TexelPages&) = delete;

    /// Writes a page of at most kPageBytes; pages count from 0. Not while others read or add.
    size_t add(std::span<const std::byte> page);
    /// Copies out.size() bytes of a page from `offset` on. Any number of threads may read.
    void read(size_t page, size_t offset, std::span<std::byte> out) const;
    /// Bytes of the pages that are or will be held in memory.
    size_t memory() const { return sets_.size() * ways_ * kPageBytes; }

  private:
    struct Slot {
        size_t page = SIZE_MAX;  ///< number of the page that it holds; SIZE_MAX: none
        uint64_t used = 0;       ///< tick of its set when it was last read
    };
    /// One set of a set-associative cache: pages compete for the slots of their set, and the page
    /// that was read longest ago gives way.
    struct Set {
        mutable std::mutex mutex;
        std::vector<Slot> slots;
        std::unique_ptr<std::byte[]> bytes;  ///< kPageBytes for each slot
        uint64_t tick = 0;
    };
    const std::byte* held(Set& set, size_t page) const;
    [[noreturn]] void fail(const char* doing, int error_number) const;

    size_t ways_;
    mutable std::vector<Set> sets_;
    std::string folder_;
    int file_ = -1;
    size_t count_ = 0;
};

}  // namespace covtrace
