/// Private to this folder: how much may be made of a file.
///
/// A buffer may be read by any number of primitives and animations, and accessors without bytes
/// hold any number of zeros: nothing but a budget bounds what a small file makes of itself.
#pragma once

#include <cstdint>

namespace covtrace::gltf {

/// An amount in proportion to a file's size, spent piece by piece.
class Budget {
  public:
    Budget() = default;
    Budget(uint64_t least, uint64_t per_byte, uint64_t bytes) : left_(least + per_byte * bytes) {}

    /// False where `count` pieces of `size` are more than what is left.
    [[nodiscard]] bool spend(uint64_t count, uint64_t size) {
        if (size > 0 && count > left_ / size) return false;
        left_ -= count * size;
        return true;
    }

  private:
    uint64_t left_ = 0;
};

/// Numbers that accessors are read as: 256 for each byte, since files hold thousands of primitives
/// that pick their triangles from the same vertices.
inline Budget budget_of_numbers(uint64_t bytes) {
    return {uint64_t{1} << 26, 256, bytes};
}

/// Bytes of all meshes. An index of one byte is one of three in a triangle of 12 bytes; meshes that
/// share vertices keep but those that they use.
inline Budget budget_of_meshes(uint64_t bytes) {
    return {uint64_t{1} << 28, 32, bytes};
}

}  // namespace covtrace::gltf
