/// From linear colours to 8-bit display values: exposure, a view transform, the display's curve.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "core/enum_names.h"
#include "core/vec.h"
#include "image/image.h"
#include "image/ocio_view.h"

namespace covtrace {

/// How the range of light is brought into that of a display.
enum class ViewTransform {
    srgb,    ///< as it is, cut at white
    filmic,  ///< a film's curve for each channel, which keeps detail up to 5.6 times white
    agx      ///< a curve over 16.5 stops in which bright colours become white
};

template <>
inline constexpr auto kEnumNames<ViewTransform> =
    enum_names<ViewTransform>({{ViewTransform::srgb, "srgb"},
                               {ViewTransform::filmic, "filmic"},
                               {ViewTransform::agx, "agx"}});

struct DisplayOptions {
    float exposure = 0;  ///< stops by which the picture is brightened
    ViewTransform view = ViewTransform::srgb;
    std::shared_ptr<const OcioView> ocio = nullptr;  ///< where there is one, in place of `view`
};

/// The options by the names that users give. `view`: one of ViewTransform, or where `ocio.config`
/// is given a view of that config; empty for the default. Throws Error(usage) for a name that is
/// not known, and otherwise as OcioView.
DisplayOptions display_options(float exposure, const std::string& view, OcioChoice ocio);

/// Display values of a linear Rec.709 colour, sRGB but where a config says otherwise. Negative
/// values and NaN count as 0.
std::array<uint8_t, 3> display_8bit(Rgb linear, const DisplayOptions& options);

/// Stops by which a picture of the root channels R, G, B is to be darkened, a whole number, so that
/// half of the pixels that are not black have a luminance of at most 0.5. 0 where half of them are
/// below 2, where they are less than a tenth of the picture, and in views that compress light.
int stops_too_bright(const Image& image, const DisplayOptions& options);

/// Writes a picture of the root channels R, G, B, or Y. Written beside and renamed. Throws as
/// write_png of image.h, which shows it with the default options.
void write_png(const Image& image, const std::filesystem::path& file,
               const DisplayOptions& options);

}  // namespace covtrace
