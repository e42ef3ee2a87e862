/// Reads the images of textures, within a bound on their memory.
#pragma once

#include <span>
#include <vector>

#include "scene/scene_description.h"
#include "shading/texture_image.h"

namespace covtrace {

struct ImageRequest {
    const ImageTexture* texture;
    const SourceLocation* where;  ///< in the scene file, for errors and warnings
};

/// The images in the order of the requests, read in parallel. Where they would hold more than
/// `most_bytes` together, the largest lose their finest mip levels, with a warning. Throws
/// Error(scene) for missing and broken files, of several the first.
std::vector<TextureImage> load_images(std::span<const ImageRequest> requests, size_t most_bytes,
                                      Warnings& warnings);

}  // namespace covtrace
