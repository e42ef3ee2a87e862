"""Functions of the angle of sight that nodes have, by the formulas of Cycles."""

import numpy as np


def reflectance(cosine, eta):
    """Reflectance of a smooth border of this relative index of refraction, by Fresnel's equations; cosine: where the light comes from."""
    inside = np.sqrt(np.maximum(1 - (1 - cosine**2) / eta**2, 0))  # 0 where all is reflected, which then makes 1
    across = ((cosine - eta * inside) / np.maximum(cosine + eta * inside, 1e-30)) ** 2
    along = ((eta * cosine - inside) / np.maximum(eta * cosine + inside, 1e-30)) ** 2
    return np.where((cosine <= 0) | (inside <= 0), 1, (across + along) / 2)


def facing(cosine, blend):
    """Layer Weight's Facing: 0 from the front, 1 edge-on; blend: a number or an array."""
    blend = np.clip(blend, 0.0, 1 - 1e-5)
    return 1 - cosine ** np.where(blend < 0.5, 2 * blend, 0.5 / (1 - blend))
