/// Factors that bring an image to the brightness at which people look at it.
#pragma once

#include "core/plane.h"

namespace covtrace {

/// Returns a power of two, at least 1, by which an image is multiplied before constants are applied
/// to it that are meant for images as displays show them, where 1 is white and errors in pixels
/// below a tenth count as they are. It depends on the brightness that a tenth of the image exceeds,
/// among the means of 8x8 pixels that have light: 1 where that is 0.1 or more, as of most images in
/// usual units; below a fortieth the image is brought to between 0.2 and 0.4, so
/// that it does not matter in which units a room by moonlight is given; in between the factor grows
/// with the square. Powers of two change no bit but the exponents. It is at most 2^20, and makes no
/// pixel brighter than 1e15.
/// `luminance`: any noise, as the means of blocks keep the light of rare samples; pixels that are
/// not finite, and blocks without light, are left out.
float display_exposure(const Plane& luminance);

/// Brightness in units of a display's white beyond which nothing is light: squares of what is
/// below, and of its noise, stay within single precision.
constexpr float kBrightestShown = 1e15f;

/// Returns the power of two, without bounds, for an image that may be in any units. For dim images
/// it is that of `display_exposure`; bright ones are brought down: 1 up to a brightness of 16,
/// from 640 on to between 0.2 and 0.4, in between falling with the square.
/// `luminance`: as above. The factor is a normal number.
float exposure_of_unknown_units(const Plane& luminance);

}  // namespace covtrace
