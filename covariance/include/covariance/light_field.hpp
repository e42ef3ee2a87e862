// LightField: a covariance together with the frame it is expressed in. Every operator comes twice,
// on the bare matrix and on this type; the second form keeps the frame right by itself.
#pragma once

#include "covariance/frame.hpp"
#include "covariance/symmetric.hpp"

namespace covariance {

/// The second moments of the spectrum of the light around a central ray.
///
/// `sigma` is over (x, y, u, v, t): metres in the plane orthogonal to `frame.z`, slopes along
/// `frame.x` and `frame.y`, seconds; units of the entries are those of frequencies, 1/m^2 and so
/// on. Between `surface_enter` and `surface_exit` x and y are tangent coordinates of the surface
/// and u, v are relative to axes that turn with its normal.
template <std::floating_point T = double>
struct LightField {
    using Scalar = T;
    SymmetricMatrix5<T> sigma;
    Frame<T> frame;

    friend constexpr bool operator==(const LightField&, const LightField&) noexcept = default;
};

}  // namespace covariance
