/// Reads the images of textures, within a bound on their memory.
#pragma once

#include <span>
#include <vector>

#include "scene/scene_description.h"
#include "texture/image.h"

namespace covtrace {

struct ImageRequest {
    const ImageTexture* texture;
    const SourceLocation* where;  ///< in the scene file, for errors and warnings
    bool is_colour = false;       ///< whether any texture takes colours from it
};

struct LoadedImages {
    std::vector<TextureImage> images;  ///< in the order of the requests
    size_t page_memory = 0;            ///< bytes for pages of those that are not in memory whole
};

/// Reads images in parallel. Where all their levels together would hold more than `most_bytes`, the
/// largest ones are moved to pages on disk (TexelPages), with a warning; what pages and the other
/// levels hold is within the bound, down to a page (16 KiB). Primaries of colours that belong to no
/// known space are a warning, too. Throws Error(scene) for missing and broken files (the first of
/// several), Error(limit) where one does not fit into memory even alone, and Error(io) where the
/// temporary file can't be written.
LoadedImages load_images(std::span<const ImageRequest> requests, size_t most_bytes,
                         Warnings& warnings);

}  // namespace covtrace
