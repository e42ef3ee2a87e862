"""Renders a scene with the package covtrace that this Python finds, and looks at its layers.

    python packaging/check_python.py VERSION SCENE
"""
import pathlib
import sys
import tempfile

import covtrace
import numpy as np


def require(is_so, text):
    if not is_so:
        raise SystemExit(f"check_python: {covtrace.__file__}: {text}")


def main(version, scene):
    # The source's and the build's packages have compiled files beside them that no package has installed.
    require({"dist-packages", "site-packages"} & set(pathlib.Path(covtrace.__file__).parts), "is not an installed package")
    require(covtrace.__version__ == version, f"is version {covtrace.__version__}, not {version}")
    image = covtrace.render(scene, spp=4, seed=1)
    require(image.complete, "the image is not complete")
    require(image.rgb.shape == (32, 48, 3) and image.rgb.dtype == np.float32, f"rgb is {image.rgb.shape}")
    require(np.isfinite(image.rgb).all() and 0.1 < image.rgb.mean() < 2, f"the image's mean is {image.rgb.mean()}")
    require(image["samples"].shape == (32, 48) and abs(image["samples"].mean() - 4) < 0.5, "the layer `samples` is wrong")
    # The ball's centre is 4.03 away, its radius half of one.
    require(3.4 < image["Z"][16, 24] < 3.7 and image["Z"][0, 0] == 0, "the layer `Z` is wrong")
    require(image.matrices("cov").shape == (32, 48, 5, 5), "the layer `cov` is wrong")
    with tempfile.TemporaryDirectory() as folder:
        name = pathlib.Path(folder, "image.exr")
        image.write(str(name))
        require(name.stat().st_size > 1000, "image.exr is empty")
    print(f"{covtrace.__file__}: {version}, mean {image.rgb.mean():.3f}")


main(*sys.argv[1:])
