#include "texture/texel_pages.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>

#include "core/error.h"

namespace covtrace {
namespace {

/// Slots of one set: enough that pages which are needed together seldom push each other out, and
/// few enough to search one by one.
constexpr size_t kWays = 8;

std::string scratch_folder() {
    const char* named = std::getenv("TMPDIR");
    return named && *named ? named : "/var/tmp";
}

/// The set that holds a page, by Fibonacci hashing: neighbouring pages fall into different sets,
/// and so do the same rows of images that begin at round numbers.
size_t set_of(size_t page, size_t sets) {
    return size_t(((page * 0x9E3779B97F4A7C15ull) >> 32) % sets);
}

}  // namespace

TexelPages::TexelPages(size_t most_bytes)
    : ways_(std::clamp(most_bytes / kPageBytes, size_t(1), kWays)),
      sets_(std::max(most_bytes / (kPageBytes * ways_), size_t(1))),
      folder_(scratch_folder()) {
    for (Set& set : sets_) set.slots.resize(ways_);
    std::string name = folder_ + "/covtrace-textures-XXXXXX";
    file_ = ::mkostemp(name.data(), O_CLOEXEC);
    if (file_ < 0) fail("create", errno);
    ::unlink(name.c_str());
}

TexelPages::~TexelPages() {
    ::close(file_);
}

size_t TexelPages::add(std::span<const std::byte> page) {
    assert(page.size() <= kPageBytes);
    for (size_t done = 0; done < page.size();) {
        const ssize_t n = ::pwrite(file_, page.data() + done, page.size() - done,
                                   off_t(count_ * kPageBytes + done));
        if (n < 0 && errno != EINTR) fail("write", errno);
        if (n > 0) done += size_t(n);
    }
    return count_++;
}

void TexelPages::read(size_t page, size_t offset, std::span<std::byte> out) const {
    assert(page < count_ && offset + out.size() <= kPageBytes);
    Set& set = sets_[set_of(page, sets_.size())];
    const std::lock_guard lock(set.mutex);
    std::memcpy(out.data(), held(set, page) + offset, out.size());
}

const std::byte* TexelPages::held(Set& set, size_t page) const {
    if (!set.bytes) set.bytes = std::make_unique_for_overwrite<std::byte[]>(ways_ * kPageBytes);
    ++set.tick;
    auto slot = std::find_if(set.slots.begin(), set.slots.end(),
                             [page](const Slot& s) { return s.page == page; });
    const bool is_held = slot != set.slots.end();
    if (!is_held)
        slot = std::min_element(set.slots.begin(), set.slots.end(),
                                [](const Slot& a, const Slot& b) { return a.used < b.used; });
    std::byte* bytes = set.bytes.get() + size_t(slot - set.slots.begin()) * kPageBytes;
    slot->used = set.tick;
    if (is_held) return bytes;
    slot->page = SIZE_MAX;
    for (size_t done = 0; done < kPageBytes;) {
        const ssize_t n =
            ::pread(file_, bytes + done, kPageBytes - done, off_t(page * kPageBytes + done));
        if (n < 0 && errno != EINTR) fail("read", errno);
        if (n == 0) break;  // the last page may be short
        if (n > 0) done += size_t(n);
    }
    slot->page = page;
    return bytes;
}

void TexelPages::fail(const char* doing, int error_number) const {
    throw Error(ErrorKind::io, std::string("cannot ") + doing +
                                   " the temporary file of textures in '" + folder_ +
                                   "': " + std::generic_category().message(error_number));
}

}  // namespace covtrace
