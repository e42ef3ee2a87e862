/// Private to this folder: bounds on the numbers and bytes that may be made of a file.
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

    /// Takes `count` pieces of `size` from the budget; false where that is more than it has left.
    [[nodiscard]] bool spend(uint64_t count, uint64_t size) {
        if (size > 0 && count > left_ / size) return false;
        left_ -= count * size;
        return true;
    }

    uint64_t left() const { return left_; }

  private:
    uint64_t left_ = 0;
};

/// Budget of the numbers that accessors are read as: 256 for each byte of the file, since files
/// hold thousands of primitives that pick their triangles from the same vertices.
inline Budget budget_of_numbers(uint64_t bytes) {
    return {uint64_t{1} << 26, 256, bytes};
}

/// Budget of the bytes of all meshes. An index of one byte is one of three in a triangle of 12
/// bytes; meshes that share vertices keep only those that they use.
inline Budget budget_of_meshes(uint64_t bytes) {
    return {uint64_t{1} << 28, 32, bytes};
}

/// Budget of the bytes that codecs decode. The best that their encoders reach is a flat grid: 112
/// times its size as Draco's mesh, of which seams and integers on the way count as much again;
/// models have 5 to 40 times. Attributes of meshopt can't exceed 64 times.
inline Budget budget_of_decoded(uint64_t bytes) {
    return {uint64_t{1} << 26, 256, bytes};
}

/// Bytes of a file that decoded ones count as in the other budgets: a quarter, so that a small file
/// that decodes to a large one does not get all the room that the large one itself would have.
inline uint64_t bytes_for_decoded(uint64_t bytes) {
    return bytes / 4;
}

}  // namespace covtrace::gltf
