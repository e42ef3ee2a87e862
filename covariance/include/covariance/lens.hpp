// The last step: from the ray that arrives at the camera to (pixel x, pixel y, lens 1, lens 2,
// shutter), axes that all paths of a pixel share, so that only from here on matrices may be
// averaged. For a moving camera call `motion_enter` right before. Aperture and shutter as windows
// are not part of this map; they enter in preintegrate.hpp.
#pragma once

#include <array>

#include "covariance/rotate.hpp"
#include "covariance/travel.hpp"

namespace covariance {

/// A thin-lens camera. The camera ray of pixel offset (i, j) and lens point (l1, l2) in the unit
/// disc starts at O + R (l1 e1 + l2 e2) and has the slope p - R l/z_f, p = (i/fpx, j/fpy).
template <std::floating_point T = double>
struct ThinLens {
    Vec3<T> e1{1, 0, 0};   ///< unit direction, in the scene, of increasing pixel x
    Vec3<T> e2{0, -1, 0};  ///< unit direction, in the scene, of increasing pixel y
    Vec3<T> e3{0, 0, -1};  ///< optical axis, unit, towards the scene
    T focus_distance = std::numeric_limits<T>::infinity();  ///< along e3, scene units
    T lens_radius = 0;                                      ///< scene units; 0 is a pinhole
    /// Pixels per unit of slope, d(pixel x)/d(tan of the angle), the focal length in pixels:
    /// width / (2 tan(horizontal field of view / 2)).
    T pixels_x = 1;
    T pixels_y = 1;
    T shutter = 1;  ///< seconds the shutter is open
};

/// An orthographic camera with a (telecentric) lens: pixels move the ray, they do not turn it. The
/// ray starts at O + i e1/px + j e2/py + R l and has the slope -R l/z_f.
template <std::floating_point T = double>
struct OrthographicLens {
    Vec3<T> e1{1, 0, 0};
    Vec3<T> e2{0, -1, 0};
    Vec3<T> e3{0, 0, -1};
    T focus_distance = std::numeric_limits<T>::infinity();
    T lens_radius = 0;
    T pixels_x = 1;  ///< pixels per scene unit
    T pixels_y = 1;
    T shutter = 1;
};

/// Any other camera, by the derivatives of its ray after (pixel x, pixel y, lens 1, lens 2): of the
/// origin in scene units, and of the unit direction as traced (towards the scene).
template <std::floating_point T = double>
struct CameraDerivatives {
    std::array<Vec3<T>, 4> origin{};
    std::array<Vec3<T>, 4> direction{};
    T shutter = 1;
};

/// Old from new coordinates for `sensor(_, _, ThinLens)`: rows x, y are (0, R P, 0), rows u, v
/// (-c P F, c P R/z_f, 0), row t (0, 0, T); P = [X.e1 X.e2; Y.e1 Y.e2], c = -Z.e3, F = diag(1/fpx,
/// 1/fpy).
template <std::floating_point T>
[[nodiscard]] constexpr Matrix5<T> sensor_matrix(const Frame<T>& f,
                                                 const ThinLens<NonDeduced<T>>& camera) noexcept {
    const Mat2<T> p = projection(f, camera.e1, camera.e2);
    const T c = -dot(f.z, camera.e3);
    Matrix5<T> a;
    a.set_block(0, 2, camera.lens_radius * p);
    a.set_block(2, 0, -c * (p * Mat2<T>{1 / camera.pixels_x, 0, 0, 1 / camera.pixels_y}));
    a.set_block(2, 2, (c * camera.lens_radius / camera.focus_distance) * p);
    a(4, 4) = camera.shutter;
    return a;
}

/// Old from new coordinates for `sensor(_, _, OrthographicLens)`: rows x, y are (P F, R P, 0), rows
/// u, v (0, c P R/z_f, 0), row t (0, 0, T).
template <std::floating_point T>
[[nodiscard]] constexpr Matrix5<T> sensor_matrix(
    const Frame<T>& f, const OrthographicLens<NonDeduced<T>>& camera) noexcept {
    const Mat2<T> p = projection(f, camera.e1, camera.e2);
    const T c = -dot(f.z, camera.e3);
    Matrix5<T> a;
    a.set_block(0, 0, p * Mat2<T>{1 / camera.pixels_x, 0, 0, 1 / camera.pixels_y});
    a.set_block(0, 2, camera.lens_radius * p);
    a.set_block(2, 2, (c * camera.lens_radius / camera.focus_distance) * p);
    a(4, 4) = camera.shutter;
    return a;
}

/// Old from new coordinates for `sensor(_, _, CameraDerivatives)`: a column holds origin.X,
/// origin.Y, -direction.X, -direction.Y of one parameter (light travels against the traced
/// direction).
template <std::floating_point T>
[[nodiscard]] constexpr Matrix5<T> sensor_matrix(
    const Frame<T>& f, const CameraDerivatives<NonDeduced<T>>& camera) noexcept {
    Matrix5<T> a;
    for (std::size_t k = 0; k < 4; ++k) {
        a(0, k) = dot(camera.origin[k], f.x);
        a(1, k) = dot(camera.origin[k], f.y);
        a(2, k) = -dot(camera.direction[k], f.x);
        a(3, k) = -dot(camera.direction[k], f.y);
    }
    a(4, 4) = camera.shutter;
    return a;
}

namespace detail {

/// Sets negative variances to zero: in focus the lens frequencies cancel, and rounding may leave a
/// little below zero.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> without_negative_axes(SymmetricMatrix5<T> s) noexcept {
    for (std::size_t i = 0; i < 5; ++i)
        if (s(i, i) < 0)
            for (std::size_t j = 0; j < 5; ++j) s(i, j) = 0;
    return s;
}

/// Writes the axes of the camera's pixels, from positions or from slopes that are already along e1,
/// e2: diag(fx, fy) times block, cross (with the frequencies of the lens) and drift (with time).
template <std::floating_point T>
constexpr void set_pixels(SymmetricMatrix5<T>& r, const Sym2<T>& block, const Mat2<T>& cross, T at,
                          T bt, T fx, T fy) noexcept {
    r.set_spatial({fx * fx * block.xx, fx * fy * block.xy, fy * fy * block.yy});
    r.set_cross({fx * cross.m00, fx * cross.m01, fy * cross.m10, fy * cross.m11});
    r(0, 4) = fx * at;
    r(1, 4) = fy * bt;
}

/// Writes the axes of the lens, W_l = R (W_x + k W_u), of light along e1, e2, and of time in
/// shutters.
template <std::floating_point T>
constexpr void set_lens(SymmetricMatrix5<T>& r, const SymmetricMatrix5<T>& s, T radius, T k,
                        T shutter) noexcept {
    r(4, 4) = shutter * shutter * s(4, 4);
    if (radius == 0) return;
    const Sym2<T> xx = s.spatial(), uu = s.angular();
    const Mat2<T> xu = s.cross();
    const auto moved = [k](T a, T twice, T b) {
        return multiply_add(k, multiply_add(k, b, twice), a);
    };
    r.set_angular((radius * radius) * Sym2<T>{moved(xx.xx, 2 * xu.m00, uu.xx),
                                              moved(xx.xy, xu.m01 + xu.m10, uu.xy),
                                              moved(xx.yy, 2 * xu.m11, uu.yy)});
    r(2, 4) = radius * shutter * multiply_add(k, s(2, 4), s(0, 4));
    r(3, 4) = radius * shutter * multiply_add(k, s(3, 4), s(1, 4));
}

}  // namespace detail

/// Maps the arriving ray to sensor coordinates (pixel, pixel, lens radius, lens radius, shutter).
///
/// On axis W_pixel = -W_u/fpx, W_lens = R (W_x + W_u/z_f), W_tau = T W_t: a texture in focus has no
/// frequency over the lens. With a pinhole rows and columns 2, 3 are zero.
/// Shapes   camera: ThinLens, OrthographicLens or CameraDerivatives.
/// Units    of the result: cycles per pixel, per lens radius and per shutter interval, squared.
/// Pre      the camera looks against the light: Z.e3 < 0. Errors: none.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> sensor(const SymmetricMatrix5<T>& s,
                                                   const Frame<NonDeduced<T>>& arriving,
                                                   const ThinLens<NonDeduced<T>>& camera) noexcept {
    const Mat2<T> p = projection(arriving, camera.e1, camera.e2);
    const T c = -dot(arriving.z, camera.e3), radius = camera.lens_radius;
    const T k = c / camera.focus_distance, shutter = camera.shutter;
    SymmetricMatrix5<T> r;
    if (radius == 0) {  // a pinhole sees slopes alone
        const T ut = p.m00 * s(2, 4) + p.m10 * s(3, 4), vt = p.m01 * s(2, 4) + p.m11 * s(3, 4);
        detail::set_pixels<T>(r, congruence(s.angular(), p), {}, shutter * ut, shutter * vt,
                              -c / camera.pixels_x, -c / camera.pixels_y);
        r(4, 4) = shutter * shutter * s(4, 4);
        return detail::without_negative_axes(r);
    }
    const auto a = change_transverse(s, p);
    // Pixels turn the ray, so they take slopes, with the lens' R (positions + k slopes).
    const Mat2<T> lens = radius * (transpose(a.cross()) + k * Mat2<T>(a.angular()));
    detail::set_pixels<T>(r, a.angular(), lens, shutter * a(2, 4), shutter * a(3, 4),
                          -c / camera.pixels_x, -c / camera.pixels_y);
    detail::set_lens<T>(r, a, radius, k, shutter);
    return detail::without_negative_axes(r);
}

/// Maps the arriving ray to the sensor of an orthographic camera.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> sensor(
    const SymmetricMatrix5<T>& s, const Frame<NonDeduced<T>>& arriving,
    const OrthographicLens<NonDeduced<T>>& camera) noexcept {
    const auto a = change_transverse(s, projection(arriving, camera.e1, camera.e2));
    const T radius = camera.lens_radius, shutter = camera.shutter;
    const T k = -dot(arriving.z, camera.e3) / camera.focus_distance;
    SymmetricMatrix5<T> r;
    // Pixels move the ray, so they take positions, with the lens' R (positions + k slopes).
    const Mat2<T> lens = radius * (Mat2<T>(a.spatial()) + k * a.cross());
    detail::set_pixels<T>(r, a.spatial(), lens, shutter * a(0, 4), shutter * a(1, 4),
                          1 / camera.pixels_x, 1 / camera.pixels_y);
    detail::set_lens<T>(r, a, radius, k, shutter);
    return detail::without_negative_axes(r);
}

/// Maps the arriving ray to the sensor of any other camera.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> sensor(
    const SymmetricMatrix5<T>& s, const Frame<NonDeduced<T>>& arriving,
    const CameraDerivatives<NonDeduced<T>>& camera) noexcept {
    return detail::without_negative_axes(transform(s, sensor_matrix<T>(arriving, camera)));
}

/// Maps a light field to the sensor; the result has left its frame for the sensor's axes.
template <std::floating_point T, typename Camera>
[[nodiscard]] constexpr SymmetricMatrix5<T> sensor(const LightField<T>& field,
                                                   const Camera& camera) noexcept {
    return sensor(field.sigma, field.frame, camera);
}

/// Applies a thin lens of focal length f in the plane of the light field, axis along Z: u_old = u +
/// x/f.
///
/// For cameras that trace through their lens, with `travel` before and behind it. Travel d and then
/// the lens gives the diagonal (1 - d/f, 1 - d/f, 1, 1, 1) of the official erratum to table II(g)
/// of Belcour et al. 2013, "5D Covariance Tracing for Efficient Defocus and Motion Blur".
///
/// Units    f in scene units, positive converges.
template <std::floating_point T>
[[nodiscard]] constexpr SymmetricMatrix5<T> lens(SymmetricMatrix5<T> s,
                                                 NonDeduced<T> focal_length) noexcept {
    // The lens is the shear of `travel` with the roles of positions and slopes exchanged: W_x' =
    // W_x + W_u/f.
    const T p = 1 / focal_length;
    s(0, 0) += p * (2 * s(0, 2) + p * s(2, 2));
    s(0, 1) += p * (s(0, 3) + s(1, 2) + p * s(2, 3));
    s(1, 1) += p * (2 * s(1, 3) + p * s(3, 3));
    s(0, 2) += p * s(2, 2);
    s(0, 3) += p * s(2, 3);
    s(1, 2) += p * s(2, 3);
    s(1, 3) += p * s(3, 3);
    s(0, 4) += p * s(2, 4);
    s(1, 4) += p * s(3, 4);
    return s;
}

/// Applies a thin lens to a light field, whose frame stays.
template <std::floating_point T>
[[nodiscard]] constexpr LightField<T> lens(const LightField<T>& field,
                                           NonDeduced<T> focal_length) noexcept {
    return {lens(field.sigma, focal_length), field.frame};
}

/// Old from new coordinates for `lens`.
template <std::floating_point T>
[[nodiscard]] constexpr Matrix5<T> lens_matrix(T focal_length) noexcept {
    Matrix5<T> a = Matrix5<T>::identity();
    a(axis::u, axis::x) = a(axis::v, axis::y) = 1 / focal_length;
    return a;
}

}  // namespace covariance
