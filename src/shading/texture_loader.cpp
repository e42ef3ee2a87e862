#include "shading/texture_loader.h"

#include <algorithm>
#include <exception>
#include <memory>
#include <optional>
#include <string>

#include "core/parallel.h"

namespace covtrace {

namespace {

using Encoding = ImageTexture::Encoding;

TextureImage load(const ImageRequest& request, Warnings& warnings) {
    const ImageTexture& t = *request.texture;
    const RasterImage raster = t.content ? decode_raster(*t.content, t.file, *request.where)
                                         : read_raster(t.file, *request.where);
    // Floating-point files are linear by definition, whatever the scene says, as in pbrt-v4.
    const bool is_encoded = raster.is_8bit || raster.is_16bit;
    const Encoding encoding = is_encoded ? t.encoding.value_or(Encoding::srgb) : Encoding::linear;
    const ColourSpace space = request.is_colour
                                  ? colour_space_of(raster, t.file, *request.where, warnings)
                                  : ColourSpace::srgb;
    TextureImage image(raster, encoding, t.gamma, t.wrap, space);
    image.build_levels();
    return image;
}

/// In parallel; of several errors the first in the order of the requests is thrown. Warnings are in
/// that order.
std::vector<TextureImage> load_some(std::span<const ImageRequest> requests, Warnings& warnings) {
    std::vector<std::optional<TextureImage>> loaded(requests.size());
    std::vector<Warnings> own_warnings(requests.size());
    std::vector<std::exception_ptr> errors(requests.size());
    parallel_for(int64_t(requests.size()), [&](int64_t i) {
        try {
            loaded[size_t(i)] = load(requests[size_t(i)], own_warnings[size_t(i)]);
        } catch (...) {
            errors[size_t(i)] = std::current_exception();
        }
    });
    for (const std::exception_ptr& e : errors)
        if (e) std::rethrow_exception(e);
    for (const Warnings& w : own_warnings) warnings.insert(warnings.end(), w.begin(), w.end());
    std::vector<TextureImage> images;
    images.reserve(loaded.size());
    for (auto& image : loaded) images.push_back(std::move(*image));
    return images;
}

/// Moves the largest levels of all images to pages, the first of equals, until the rest fits. Done
/// after every few files it ends as if done after the last: what is too large beside some images is
/// too large beside all.
class Budget {
  public:
    explicit Budget(size_t most_bytes) : most_bytes_(most_bytes) {}

    void fit(std::vector<TextureImage>& images) {
        size_t bytes = 0;
        for (const TextureImage& image : images) bytes += image.memory();
        if (!pages_) {
            if (bytes <= most_bytes_) return;
            // One half for pages, the other for levels that are in memory as a whole.
            pages_ = std::make_shared<TexelPages>(most_bytes_ / 2);
        }
        const size_t most_whole = most_bytes_ - std::min(most_bytes_, pages_->memory());
        while (bytes > most_whole) {
            const auto largest = std::max_element(
                images.begin(), images.end(), [](const TextureImage& a, const TextureImage& b) {
                    return a.finest_in_memory() < b.finest_in_memory();
                });
            bytes -= largest->finest_in_memory();
            largest->move_finest_to(pages_);
        }
    }

    size_t page_memory() const { return pages_ ? pages_->memory() : 0; }

  private:
    size_t most_bytes_;
    std::shared_ptr<TexelPages> pages_;
};

}  // namespace

LoadedImages load_images(std::span<const ImageRequest> requests, size_t most_bytes,
                         Warnings& warnings) {
    constexpr size_t kBatch = 8;  // so that little but the result is ever in memory
    LoadedImages loaded;
    Budget budget(most_bytes);
    size_t bytes = 0;
    for (size_t first = 0; first < requests.size(); first += kBatch) {
        const size_t count = std::min(kBatch, requests.size() - first);
        for (TextureImage& image : load_some(requests.subspan(first, count), warnings)) {
            bytes += image.memory();
            loaded.images.push_back(std::move(image));
        }
        budget.fit(loaded.images);
    }
    loaded.page_memory = budget.page_memory();
    const auto paged = std::count_if(loaded.images.begin(), loaded.images.end(),
                                     [](const TextureImage& i) { return i.is_paged(); });
    if (paged > 0)
        warnings.push_back({{},
                            "textures take " + std::to_string(bytes) + " bytes and may take " +
                                std::to_string(most_bytes) + ": " + std::to_string(paged) + " of " +
                                std::to_string(loaded.images.size()) +
                                " images are read from a temporary file while they are rendered"});
    return loaded;
}

}  // namespace covtrace
