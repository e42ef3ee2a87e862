/// The layers of another renderer's image that a reconstruction reads, found by their names.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "image/image.h"

namespace covtrace {

/// Names of layers, in place of those that are known: "denoise.albedo" for the channels
/// denoise.albedo.R, .G, .B. Empty: found by the known names. "none": not used.
struct LayerNaming {
    std::string color, variance, albedo, normal, depth;
};

/// Channels of a layer: red, green, blue or x, y, z.
using LayerChannels = std::array<const Channel*, 3>;

/// The layers of an image. They point into it.
struct FoundLayers {
    LayerChannels color;
    std::optional<LayerChannels> variance, albedo, normal;
    /// Distance from the camera: one channel, or the place in the camera's space, whose length is
    /// the distance.
    std::optional<LayerChannels> place;
    const Channel* depth = nullptr;
    const Channel* samples = nullptr;  ///< samples per pixel, over samples_unit
    /// Samples that 1 stands for: Cycles divides its counts by the most that a pixel may get.
    float samples_unit = 1;
    /// Whether the variance is that of one sample, as pbrt writes it, and not of the pixel's mean.
    bool is_variance_of_one = false;
};

/// Finds the layers by the names that pbrt-v4 ("gbuffer" film), Mitsuba 3 ("aov" integrator),
/// Cycles (passes of multilayer files) and covtrace write, after restore_layer_names, and by those
/// that Arnold, RenderMan and V-Ray call what their own denoisers read; where an
/// image has its noisy pixels beside denoised ones, those are the colour. `file` names the image in
/// errors. Throws Error(usage) where there is no colour, or where a layer that was named is missing
/// or has the wrong number of channels; the message lists the layers that there are.
FoundLayers find_layers(const Image& image, const LayerNaming& naming, const std::string& file);

/// Samples per pixel as the image's metadata have them: those of covtrace, pbrt-v4 and Cycles.
std::optional<float> samples_in_metadata(const Image& image);

}  // namespace covtrace
