/// Memory for large tables that are read here and there: in pages of 2 MB where the system has
/// them, so that a look-up does not wait for the address of its page as well.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <new>
#include <vector>

namespace covtrace {

/// Allocator for containers of large tables. Small ones, and those of systems without such pages,
/// get ordinary memory.
template <typename T>
struct HugePageAllocator {
    using value_type = T;
    HugePageAllocator() = default;
    template <typename U>
    HugePageAllocator(const HugePageAllocator<U>&) {}

    T* allocate(size_t count) {
        const size_t bytes = count * sizeof(T);
        if (bytes < kPage / 2) return std::allocator<T>().allocate(count);
        if (count > static_cast<size_t>(-1) / sizeof(T) - kPage) throw std::bad_alloc();
        const size_t whole = (bytes + kPage - 1) / kPage * kPage;
        void* memory = std::aligned_alloc(kPage, whole);
        if (!memory) throw std::bad_alloc();
        madvise(memory, whole, MADV_HUGEPAGE);  // advice: nothing is lost where it is not taken
        return static_cast<T*>(memory);
    }
    void deallocate(T* memory, size_t count) {
        if (count * sizeof(T) < kPage / 2)
            std::allocator<T>().deallocate(memory, count);
        else
            std::free(memory);
    }
    bool operator==(const HugePageAllocator&) const { return true; }

  private:
    static constexpr size_t kPage = size_t{2} << 20;
};

template <typename T>
using HugePageVector = std::vector<T, HugePageAllocator<T>>;

}  // namespace covtrace
