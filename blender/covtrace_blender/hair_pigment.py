"""Absorption in strands of hair, per radius, as Blender's Principled Hair describes it: by pigments, or by the colour of dense hair
(Chiang et al. 2016, "A Practical and Controllable Hair and Fur Model for Production Path Tracing")."""

import numpy as np

# Absorption of the pigments eumelanin and pheomelanin, per concentration, as Cycles has it.
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
