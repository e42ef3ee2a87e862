/// Private to this folder: reads the bytes of a file from front to back and never beyond its end.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

#include "image/plain_image.h"

namespace covtrace {

class ByteReader {
  public:
    explicit ByteReader(Bytes bytes) : bytes_(bytes) {}

    bool at_end() const { return bytes_.empty(); }
    Bytes rest() const { return bytes_; }
    /// The next `count` bytes; throws DecodeError where fewer are left.
    Bytes take(size_t count) {
        if (count > bytes_.size()) throw DecodeError("the file ends too early");
        const Bytes taken = bytes_.first(count);
        bytes_ = bytes_.subspan(count);
        return taken;
    }
    uint8_t u8() { return take(1)[0]; }
    uint16_t little_u16() {
        const Bytes b = take(2);
        return uint16_t(b[0] | b[1] << 8);
    }
    uint16_t big_u16() {
        const Bytes b = take(2);
        return uint16_t(b[0] << 8 | b[1]);
    }
    uint32_t little_u32() {
        const uint32_t low = little_u16();
        return low | uint32_t(little_u16()) << 16;
    }
    uint32_t big_u32() {
        const uint32_t high = big_u16();
        return high << 16 | big_u16();
    }

  private:
    Bytes bytes_;
};

}  // namespace covtrace
