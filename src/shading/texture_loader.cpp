#include "shading/texture_loader.h"

#include <algorithm>
#include <array>
#include <exception>
#include <optional>
#include <string>

#include "core/parallel.h"

namespace covtrace {

namespace {

using Encoding = ImageTexture::Encoding;

TextureImage load(const ImageRequest& request) {
    const ImageTexture& t = *request.texture;
    const RasterImage raster = t.content ? decode_raster(*t.content, t.file, *request.where)
                                         : read_raster(t.file, *request.where);
    // Floating-point files are linear by definition, whatever the scene says, as in pbrt-v4.
    const bool is_encoded = raster.is_8bit || raster.is_16bit;
    const Encoding encoding = is_encoded ? t.encoding.value_or(Encoding::srgb) : Encoding::linear;
    TextureImage image(raster, encoding, t.gamma, t.wrap);
    image.build_levels();
    return image;
}

/// In parallel; of several errors the first in the order of the requests is thrown.
std::vector<TextureImage> load_some(std::span<const ImageRequest> requests) {
    std::vector<std::optional<TextureImage>> loaded(requests.size());
    std::vector<std::exception_ptr> errors(requests.size());
    parallel_for(int64_t(requests.size()), [&](int64_t i) {
        try {
            loaded[size_t(i)] = load(requests[size_t(i)]);
        } catch (...) {
            errors[size_t(i)] = std::current_exception();
        }
    });
    for (const std::exception_ptr& e : errors)
        if (e) std::rethrow_exception(e);
    std::vector<TextureImage> images;
    images.reserve(loaded.size());
    for (auto& image : loaded) images.push_back(std::move(*image));
    return images;
}

/// Halves the largest of the images, the first of equals, until all fit. Done after every few files
/// it ends as if done after the last: what a part of the images makes too large stays too large.
void fit(std::vector<TextureImage>& images, size_t most_bytes) {
    size_t bytes = 0;
    for (const TextureImage& image : images) bytes += image.memory();
    while (bytes > most_bytes) {
        const auto largest = std::max_element(
            images.begin(), images.end(),
            [](const TextureImage& a, const TextureImage& b) { return a.memory() < b.memory(); });
        const size_t before = largest->memory();
        largest->halve();
        if (largest->memory() == before) return;  // single texels
        bytes -= before - largest->memory();
    }
}

}  // namespace

std::vector<TextureImage> load_images(std::span<const ImageRequest> requests, size_t most_bytes,
                                      Warnings& warnings) {
    constexpr size_t kBatch = 8;  // so that little but the result is ever in memory
    std::vector<TextureImage> images;
    std::vector<std::array<int, 2>> sizes;
    for (size_t first = 0; first < requests.size(); first += kBatch) {
        const size_t count = std::min(kBatch, requests.size() - first);
        for (TextureImage& image : load_some(requests.subspan(first, count))) {
            sizes.push_back({image.width(), image.height()});
            images.push_back(std::move(image));
        }
        fit(images, most_bytes);
    }
    for (size_t i = 0; i < images.size(); ++i)
        if (images[i].width() != sizes[i][0])
            warnings.push_back(
                {*requests[i].where, "to keep textures within their memory, an image of " +
                                         std::to_string(sizes[i][0]) + "x" +
                                         std::to_string(sizes[i][1]) + " is used at " +
                                         std::to_string(images[i].width()) + "x" +
                                         std::to_string(images[i].height())});
    return images;
}

}  // namespace covtrace
