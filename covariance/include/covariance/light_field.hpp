// LightField: a covariance together with the frame it is expressed in. Operators that take and give
// this type keep the frame right by themselves; those that need no frame, or are given it, also
// come on the bare matrix.
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
