"""The operators of the covariance library on numpy arrays.

A covariance `sigma` is (..., 5, 5) over (x, y, u, v, t): positions, slopes, time, in ordinary
frequencies squared (cycles per unit). A `frame` is (..., 3, 3), the rows X, Y, Z with Z the way the
light goes. A `surface` is (..., 3, 3), the rows t1, t2, n, with its `curvature` (..., 2, 2) in the
basis t1, t2. 2x2 matrices are (..., 2, 2), directions (..., 3). Leading dimensions broadcast as
numpy's. Results are new float64 arrays. Operators that change the ray's direction return (sigma,
frame).

Formulas and sources stand in the library's headers; the names are the same.
"""

from typing import Tuple

import numpy as _numpy
from numpy.typing import ArrayLike, NDArray

from ._covtrace import covariance as _c

Array = NDArray[_numpy.float64]
LightField = Tuple[Array, Array]

disc_lens_window: float = _c.disc_lens_window
square_lens_window: float = _c.square_lens_window
box_shutter_window: float = _c.box_shutter_window

_FLAT = _numpy.zeros((2, 2))
_STILL = _numpy.zeros(3)


def transform(sigma: ArrayLike, matrix: ArrayLike) -> Array:
    """The master rule A^T Sigma A; `matrix` gives the old coordinates from the new ones."""
    return _c.transform(sigma, matrix)


def travel(sigma: ArrayLike, distance: ArrayLike) -> Array:
    """Free travel over `distance` in scene units."""
    return _c.travel(sigma, distance)


def lens(sigma: ArrayLike, focal_length: ArrayLike) -> Array:
    """Passage through an ideal thin lens."""
    return _c.lens(sigma, focal_length)


def change_transverse(sigma: ArrayLike, q: ArrayLike) -> Array:
    """A linear change of the transverse axes, old from new: positions and slopes alike."""
    return _c.change_transverse(sigma, q)


def rotate_to(sigma: ArrayLike, frame: ArrayLike, new_frame: ArrayLike) -> LightField:
    """The same light in another frame of the same ray; returns (sigma, frame)."""
    return _c.rotate_to(sigma, frame, new_frame)


def frame_along(direction: ArrayLike) -> Array:
    """Some right-handed frame with the unit direction as Z."""
    return _c.frame_along(direction)


def occlude(sigma: ArrayLike, dx: ArrayLike, dy: ArrayLike, distance: ArrayLike,
            vx: ArrayLike = 0.0, vy: ArrayLike = 0.0) -> Array:
    """One occluding edge at `distance` in the unit transverse direction (dx, dy), moving with
    (vx, vy)."""
    return _c.occlude(sigma, dx, dy, distance, vx, vy)


def motion_enter(sigma: ArrayLike, frame: ArrayLike, velocity: ArrayLike,
                 angular_velocity: ArrayLike = _STILL) -> Array:
    """Change into the coordinates that move with the object, at its point that the ray hits."""
    return _c.motion_enter(sigma, frame, velocity, angular_velocity)


def motion_exit(sigma: ArrayLike, frame: ArrayLike, velocity: ArrayLike,
                angular_velocity: ArrayLike = _STILL) -> Array:
    """Change back into coordinates at rest, along the leaving ray's frame."""
    return _c.motion_exit(sigma, frame, velocity, angular_velocity)


def surface_enter(sigma: ArrayLike, frame: ArrayLike, surface: ArrayLike,
                  curvature: ArrayLike = _FLAT) -> Array:
    """Change from the arriving ray's coordinates to those of the surface."""
    return _c.surface_enter(sigma, frame, surface, curvature)


def surface_exit(sigma: ArrayLike, frame: ArrayLike, surface: ArrayLike,
                 curvature: ArrayLike = _FLAT) -> Array:
    """Change from the surface's coordinates to those of the leaving ray."""
    return _c.surface_exit(sigma, frame, surface, curvature)


def reflect_specular(sigma: ArrayLike, frame: ArrayLike, surface: ArrayLike,
                     outgoing: ArrayLike) -> LightField:
    """Reflection by a perfect mirror; returns (sigma, frame)."""
    return _c.reflect_specular(sigma, frame, surface, outgoing)


def reflect_lobe(sigma: ArrayLike, frame: ArrayLike, surface: ArrayLike, outgoing: ArrayLike,
                 lobe: ArrayLike) -> LightField:
    """Reflection by any lobe of covariance `lobe` (1/rad^2, in leaving slopes); returns (sigma,
    frame)."""
    return _c.reflect_lobe(sigma, frame, surface, outgoing, lobe)


def reflect_glossy(sigma: ArrayLike, frame: ArrayLike, surface: ArrayLike, outgoing: ArrayLike,
                   micro: ArrayLike) -> LightField:
    """Reflection by a microfacet surface, with its slopes' covariance `micro` along t1, t2; returns
    (sigma, frame)."""
    return _c.reflect_glossy(sigma, frame, surface, outgoing, micro)


def reflect_diffuse(sigma: ArrayLike, frame: ArrayLike, surface: ArrayLike,
                    outgoing: ArrayLike) -> LightField:
    """Lambertian reflection; returns (sigma, frame)."""
    return _c.reflect_diffuse(sigma, frame, surface, outgoing)


def refract(sigma: ArrayLike, frame: ArrayLike, surface: ArrayLike, outgoing: ArrayLike,
            n1: ArrayLike, n2: ArrayLike) -> LightField:
    """Smooth refraction from index n1 into n2; returns (sigma, frame)."""
    return _c.refract(sigma, frame, surface, outgoing, n1, n2)


def refract_glossy(sigma: ArrayLike, frame: ArrayLike, surface: ArrayLike, outgoing: ArrayLike,
                   n1: ArrayLike, n2: ArrayLike, micro: ArrayLike) -> LightField:
    """Refraction by a rough surface; returns (sigma, frame)."""
    return _c.refract_glossy(sigma, frame, surface, outgoing, n1, n2, micro)


def convolve_angular(sigma: ArrayLike, kernel: ArrayLike) -> Array:
    """Convolution of the slopes with a lobe whose spectrum has the covariance `kernel`."""
    return _c.convolve_angular(sigma, kernel)


def add_angular_window(sigma: ArrayLike, window: ArrayLike) -> Array:
    """Multiplication by an angular window whose spectrum has the covariance `window`."""
    return _c.add_angular_window(sigma, window)


def add_texture(sigma: ArrayLike, texture: ArrayLike) -> Array:
    """Multiplication by a texture whose spectrum has the covariance `texture` along t1, t2."""
    return _c.add_texture(sigma, texture)


def micro_beckmann(alpha_x: ArrayLike, alpha_y: ArrayLike) -> Array:
    """Slope covariance of a Beckmann distribution."""
    return _c.micro_beckmann(alpha_x, alpha_y)


def micro_ggx(alpha_x: ArrayLike, alpha_y: ArrayLike) -> Array:
    """Slope covariance of a GGX distribution."""
    return _c.micro_ggx(alpha_x, alpha_y)


def phong_cov(exponent: ArrayLike) -> Array:
    """Covariance of a Phong lobe."""
    return _c.phong_cov(exponent)


def disc_moments(radius: ArrayLike) -> Array:
    """Second moments of a disc."""
    return _c.disc_moments(radius)


def rectangle_moments(a: ArrayLike, b: ArrayLike) -> Array:
    """Second moments of a rectangle with the sides a and b."""
    return _c.rectangle_moments(a, b)


def area_source(moments: ArrayLike) -> Array:
    """A Lambertian emitter in the tangent coordinates of its surface; surface_exit must follow."""
    return _c.area_source(moments)


def point_source(r_min: ArrayLike) -> Array:
    """A point light, capped at the radius r_min."""
    return _c.point_source(r_min)


def sun_source(angular_radius: ArrayLike) -> Array:
    """A distant disc of the angular radius in radians."""
    return _c.sun_source(angular_radius)


def distant_source(angular: ArrayLike) -> Array:
    """Light from far away with the angular covariance `angular`."""
    return _c.distant_source(angular)


def sensor(sigma: ArrayLike, frame: ArrayLike, axes: ArrayLike,
           focus_distance: ArrayLike = float("inf"), lens_radius: ArrayLike = 0.0,
           pixels_x: ArrayLike = 1.0, pixels_y: ArrayLike = 1.0, shutter: ArrayLike = 1.0) -> Array:
    """Change into (pixel x, pixel y, lens u, lens v, shutter) of a perspective camera with a thin
    lens.

    axes: (..., 3, 3), rows e1 (pixel x), e2 (pixel y), e3 (optical axis, towards the scene);
    pixels: focal length in pixels; shutter in seconds.
    """
    return _c.sensor(sigma, frame, axes, focus_distance, lens_radius, pixels_x, pixels_y, shutter)


def sensor_orthographic(sigma: ArrayLike, frame: ArrayLike, axes: ArrayLike,
                        focus_distance: ArrayLike = float("inf"), lens_radius: ArrayLike = 0.0,
                        pixels_x: ArrayLike = 1.0, pixels_y: ArrayLike = 1.0,
                        shutter: ArrayLike = 1.0) -> Array:
    """Change into the coordinates of an orthographic camera, as `sensor`; pixels: per scene unit."""
    return _c.sensor_orthographic(sigma, frame, axes, focus_distance, lens_radius, pixels_x,
                                  pixels_y, shutter)


def sensor_window(lens: ArrayLike = disc_lens_window,
                  shutter: ArrayLike = box_shutter_window) -> Array:
    """The window that lens and shutter integrate over, as a covariance: diag(0, 0, lens, lens,
    shutter)."""
    return _c.sensor_window(lens, shutter)


def preintegrate(sigma: ArrayLike, window: ArrayLike | None = None) -> Array:
    """The 2x2 spectrum of the image, (cycles/pixel)^2, after lens and shutter."""
    return _c.preintegrate(sigma, sensor_window() if window is None else window)


def integration_count(sigma: ArrayLike, window: ArrayLike | None = None) -> Array | float:
    """Samples per pixel that lens and shutter alone ask for."""
    return _c.integration_count(sigma, sensor_window() if window is None else window)


def image_density(spectrum: ArrayLike) -> Array | float:
    """The density sqrt(det) of a 2x2 spectrum."""
    return _c.image_density(spectrum)


def hypercube_density(spectrum: ArrayLike, integration: ArrayLike) -> Array | float:
    """The density sqrt|S| per pixel, whole aperture and whole shutter, from `preintegrate` and
    `integration_count`: times k it is the number of samples per pixel of Belcour 2012, section
    5.1, equation 5.3."""
    return _c.hypercube_density(spectrum, integration)


def filter_sharpness(samples_per_pixel: ArrayLike) -> Array | float:
    """The constant c of the reconstruction filter at a number of samples per pixel."""
    return _c.filter_sharpness(samples_per_pixel)


def filter_covariance(spectrum: ArrayLike, c: ArrayLike = 2.0, s_min: ArrayLike = 0.5,
                      s_max: ArrayLike = 15.0) -> Array:
    """The reconstruction filter's covariance in pixels^2, deviations within [s_min, s_max]."""
    return _c.filter_covariance(spectrum, c, s_min, s_max)


def thesis_filter_covariance(spectrum: ArrayLike, s_min: ArrayLike = 0.5,
                             s_max: ArrayLike = 15.0) -> Array:
    """The reconstruction filter's covariance by Belcour 2012, equation 5.7 as printed."""
    return _c.thesis_filter_covariance(spectrum, s_min, s_max)
