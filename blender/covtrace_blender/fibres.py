"""Strands of hair: the light that they send back and let pass, by the model of Chiang et al. 2016, "A Practical and Controllable
Hair and Fur Model for Production Path Tracing", which is that of Blender's Principled Hair."""

import numpy as np

from . import fresnel

# Absorption of the pigments eumelanin and pheomelanin, per concentration and radius of a strand.
EUMELANIN, PHEOMELANIN = np.array([0.506, 0.841, 1.653]), np.array([0.343, 0.733, 1.924])


def absorption_of_pigments(melanin, redness):
    """melanin: 0 to 1, evenly to the eye; redness: the share of pheomelanin."""
    concentration = -np.log(max(1 - melanin, 1e-4))
    return concentration * ((1 - redness) * EUMELANIN + redness * PHEOMELANIN)


def absorption_of_colour(colour, radial_roughness):
    """Absorption of hair that has this colour where it is dense; equation 9."""
    b = radial_roughness
    scale = 5.969 - 0.215 * b + 2.532 * b**2 - 10.73 * b**3 + 5.574 * b**4 + 0.245 * b**5
    return (np.log(np.clip(colour, 1e-5, 1)) / scale) ** 2


def shares_of_fibre(absorption, eta):
    """(shares sent back, shares let pass), an array each, of even light that falls on strands from all around. absorption: (n,)."""
    offsets, sines = (np.arange(64) + 0.5) / 64, (np.arange(32) + 0.5) / 32
    h, sine = np.meshgrid(offsets, sines)  # place across the strand; of the angle to its cross section
    cosine = np.sqrt(1 - sine**2)
    along = np.sqrt(1 - (sine / eta) ** 2)  # cosine of that angle inside
    bent = np.sqrt(eta**2 - sine**2) / cosine  # index in the cross section
    inside = np.sqrt(1 - (h / bent) ** 2)
    reflected = fresnel.reflectance(cosine * np.sqrt(1 - h**2), eta)
    passed = np.exp(-np.asarray(absorption)[:, None, None] * 2 * inside / along)
    through = (1 - reflected) ** 2 * passed
    returned = through * passed * reflected
    later = returned * passed * reflected / (1 - passed * reflected)  # in all directions
    weight = cosine / np.sum(cosine)
    return (np.sum((reflected + returned + later / 2) * weight, axis=(1, 2)),
            np.sum((through + later / 2) * weight, axis=(1, 2)))


class Wall:
    """The wall of a hollow tube that sends on as much light as a strand of this index does, and sends back as much: what enters
    the tube leaves by the wall's transmittance, or is reflected inside until it does."""

    def __init__(self, eta):
        self.eta = eta
        self.roots = np.linspace(0, 4, 129)  # of absorptions; beyond, nothing passes
        back, forward = shares_of_fibre(self.roots**2, max(eta, 1.0001))
        self.reflectances, self.transmittances = back, np.sqrt(forward * (1 - back))

    def reflectance(self, absorption):
        """The reflectance for an absorption, an array of any shape."""
        return np.interp(np.sqrt(absorption), self.roots, self.reflectances)

    def transmittance(self, absorption):
        return np.interp(np.sqrt(absorption), self.roots, self.transmittances)
