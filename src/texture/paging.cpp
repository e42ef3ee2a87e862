// The levels of a TextureImage that lie on the disk.
#include <algorithm>
#include <cstring>

#include "texture/image.h"

namespace covtrace {

int TextureImage::tile_bits() const {
    int bits = 0;
    while ((texel_bytes() << (2 * (bits + 1))) <= TexelPages::kPageBytes) ++bits;
    return bits;
}

size_t TextureImage::finest_in_memory() const {
    for (const Level& level : levels_)
        if (!level.pages) return level.bytes.size() + level.floats.size() * sizeof(float);
    return 0;
}

void TextureImage::move_finest_to(const std::shared_ptr<TexelPages>& pages) {
    const auto level = std::find_if(levels_.begin(), levels_.end(),
                                    [](const Level& l) { return l.pages == nullptr; });
    if (level == levels_.end()) return;
    const size_t bytes = texel_bytes(), side = size_t(1) << tile_bits(),
                 width = size_t(level->width), height = size_t(level->height);
    const auto values =
        is_8bit_ ? std::as_bytes(std::span(level->bytes)) : std::as_bytes(std::span(level->floats));
    std::vector<std::byte> tile(side * side * bytes);
    bool is_first = true;
    for (size_t top = 0; top < height; top += side)
        for (size_t left = 0; left < width; left += side) {
            // Tiles at the right and lower border keep in their unused part the texels of an
            // earlier tile, which nobody reads.
            const size_t columns = std::min(side, width - left);
            for (size_t y = 0; y < std::min(side, height - top); ++y)
                std::memcpy(tile.data() + y * side * bytes,
                            values.data() + ((top + y) * width + left) * bytes, columns * bytes);
            const size_t page = pages->add(tile);
            if (is_first) level->first_page = page;
            is_first = false;
        }
    // The vectors are replaced, not cleared: clearing or assigning a list would keep their memory.
    level->bytes = std::vector<uint8_t>();
    level->floats = std::vector<float>();
    level->pages = pages;
}

TextureImage::Texel TextureImage::paged_texel(const Level& level, size_t texel,
                                              TexelBuffer& buffer) const {
    const int bits = tile_bits();
    const size_t width = size_t(level.width), side = size_t(1) << bits, rest = side - 1;
    const size_t x = texel % width, y = texel / width;
    const size_t tiles_across = (width + rest) >> bits;
    const size_t page = level.first_page + (y >> bits) * tiles_across + (x >> bits);
    const size_t offset = (((y & rest) << bits) + (x & rest)) * texel_bytes();
    std::span<std::byte> out = std::as_writable_bytes(std::span(buffer.floats));
    if (is_8bit_) out = std::as_writable_bytes(std::span(buffer.bytes));
    level.pages->read(page, offset, out.first(texel_bytes()));
    if (is_8bit_) return {buffer.bytes.data(), nullptr};
    return {nullptr, buffer.floats.data()};
}

}  // namespace covtrace
