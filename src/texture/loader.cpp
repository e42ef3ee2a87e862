#include "texture/loader.h"

#include <algorithm>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "core/memory_limit.h"
#include "core/parallel.h"

namespace covtrace {

namespace {

using Encoding = ImageTexture::Encoding;

TextureImage load(const ImageRequest& request, Warnings& warnings) {
    const ImageTexture& t = *request.texture;
    RasterImage raster = t.content ? decode_raster(*t.content, t.file, *request.where)
                                   : read_raster(t.file, *request.where);
    // Floating-point files are linear by definition, whatever the scene says, as in pbrt-v4.
    const bool is_encoded = raster.is_8bit || raster.is_16bit;
    const Encoding encoding = is_encoded ? t.encoding.value_or(Encoding::srgb) : Encoding::linear;
    const ColourSpace space = request.is_colour
                                  ? colour_space_of(raster, t.file, *request.where, warnings)
                                  : ColourSpace::srgb;
    const size_t bytes = raster.bytes.size() + raster.values.size() * sizeof(float);
    // The coarser levels have together a third of the finest one's texels.
    const MemoryReservation room(bytes / 3, "the coarser levels of '" + t.file.string() + "'",
                                 *request.where);
    TextureImage image(std::move(raster), encoding, t.gamma, t.wrap, space);
    image.build_levels();
    return image;
}

struct Loaded {
    std::optional<TextureImage> image;
    Warnings warnings;
    std::exception_ptr error;
    bool lacked_memory = false;
};

Loaded try_to_load(const ImageRequest& request) {
    Loaded loaded;
    try {
        loaded.image = made_of(request.texture->file, *request.where,
                               [&] { return load(request, loaded.warnings); });
    } catch (const Error& e) {
        loaded.error = std::current_exception();
        loaded.lacked_memory = e.kind() == ErrorKind::limit;
    } catch (...) {
        loaded.error = std::current_exception();
    }
    return loaded;
}

/// Keeps images within their memory: moves the largest levels of all images to pages, the first of
/// equals, until the rest fits. Run after every few files it ends as if run after the last: what is
/// too large beside some images is too large beside all.
class Budget {
  public:
    explicit Budget(size_t most_bytes) : most_bytes_(most_bytes) {}

    void fit(std::vector<TextureImage>& images) {
        size_t bytes = 0;
        for (const TextureImage& image : images) bytes += image.memory();
        if (!pages_) {
            if (bytes <= most_bytes_) return;
            // The budget is halved: one half for pages, the other for levels that are in memory as
            // a whole.
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
    std::vector<Loaded> batch;
    for (size_t first = 0; first < requests.size(); first += kBatch) {
        const size_t count = std::min(kBatch, requests.size() - first);
        batch.clear();
        batch.resize(count);
        parallel_for(int64_t(count), [&](int64_t i) {
            batch[size_t(i)] = try_to_load(requests[first + size_t(i)]);
        });
        for (size_t i = 0; i < count; ++i) {
            // An image that did not fit beside others may fit alone, once those before it have gone
            // to pages.
            if (batch[i].lacked_memory) {
                budget.fit(loaded.images);
                for (size_t k = i; k < count; ++k) batch[k] = {};
            }
            if (!batch[i].image && !batch[i].error) {
                batch[i] = try_to_load(requests[first + i]);
                budget.fit(loaded.images);
            }
            if (batch[i].error) std::rethrow_exception(batch[i].error);
            warnings.insert(warnings.end(), batch[i].warnings.begin(), batch[i].warnings.end());
            bytes += batch[i].image->memory();
            loaded.images.push_back(*std::exchange(batch[i].image, std::nullopt));
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
