"""Fresnel's reflectance, and means over all directions of what the angle of sight decides, each direction counting by its cosine."""

import numpy as np


def reflectance(cosine, eta):
    """Reflectance of a smooth border of this index of refraction, at least 1, by Fresnel's equations; cosine: outside, an array."""
    inside = np.sqrt(1 - (1 - cosine**2) / eta**2)
    across = ((cosine - eta * inside) / (cosine + eta * inside)) ** 2
    along = ((eta * cosine - inside) / (eta * cosine + inside)) ** 2
    return (across + along) / 2


def mean_reflectance(eta):
    """Its mean."""
    cosine = (np.arange(1000) + 0.5) / 1000
    return float(np.mean(2 * reflectance(cosine, eta) * cosine))


def exponent_of_facing(blend):
    """The exponent b of Layer Weight's Facing, 1 - cos^b; blend: a number or an array."""
    blend = np.clip(blend, 0.0, 1 - 1e-5)
    return np.where(blend < 0.5, 2 * blend, 0.5 / (1 - blend))


def mean_facing(blend):
    """Its mean."""
    return float(1 - 2 / (exponent_of_facing(blend) + 2))
