"""The argument of a progress callback."""

from typing import NamedTuple


class Progress(NamedTuple):
    """State of a render; `remaining` and `error` are NaN where they are not known yet."""

    phase: str  #: "covariance", "radiance", "reconstruction"
    fraction: float  #: of the whole render, in [0, 1); 1 of a `RunningRender` with its image
    samples_per_pixel: float  #: taken so far
    elapsed: float  #: seconds
    remaining: float  #: estimated seconds
    error: float  #: estimated sqrt(relMSE)
