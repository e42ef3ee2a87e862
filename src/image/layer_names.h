/// Names of an image's layers in files: our own, or those that tools of other renderers look for.
#pragma once

#include "core/enum_names.h"
#include "image/image.h"

namespace covtrace {

enum class LayerNames {
    standard,
    /// pbrt-v4's "gbuffer" film: Albedo.R …, Ns.X … (our N is the shading normal), Variance.R …;
    /// layers that pbrt has no name for keep ours.
    pbrt,
    /// Blender's multilayer files, "layer.pass.channel" with one letter for the channel:
    /// ViewLayer.Combined.R, ViewLayer.Depth.Z, "ViewLayer.Denoising Normal.X", "ViewLayer.Noisy
    /// Image.R" (our raw) …; the entries of symmetric 2x2 layers become X, Y, Z, and each entry of
    /// cov and share a pass of its own.
    blender
};

template <>
inline constexpr auto kEnumNames<LayerNames> =
    enum_names<LayerNames>({{LayerNames::standard, "default"},
                            {LayerNames::pbrt, "pbrt"},
                            {LayerNames::blender, "blender"}});

/// Renames the channels of an image that has our own names.
void rename_layers(Image& image, LayerNames names);

/// Restores our own names, for images in either convention, which is recognised by "Albedo.R", by
/// "….Combined.R" or by "….Denoising Albedo.R"; other images stay as they are.
void restore_layer_names(Image& image);

}  // namespace covtrace
