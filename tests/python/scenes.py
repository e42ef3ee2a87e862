"""Small scenes for the tests of the package."""

import numpy

import covtrace


def quad(size=3.0, height=0.0):
    vertices = [[-size, height, -size], [size, height, -size], [size, height, size],
                [-size, height, size]]
    return vertices, numpy.array([[0, 2, 1], [0, 3, 2]])


def builder(resolution=(48, 27), **camera):
    """A textured floor and a moving ball under a sky and an area light."""
    scene = covtrace.SceneBuilder()
    scene.camera(eye=(0, 1.2, 4), target=(0, 0.4, 0), fov=40, resolution=resolution, **camera)
    scene.integrator(max_depth=4, spp=4)
    even = (numpy.indices((32, 32)).sum(0) // 4) % 2
    scene.texture("checks", numpy.stack([0.1 + 0.8 * even, 0.2 + 0.6 * even, 0.1 + 0.2 * even], -1))
    scene.material("floor", "diffuse", **{"texture reflectance": "checks"})
    scene.material("red", "coateddiffuse", reflectance=(0.6, 0.1, 0.1), roughness=0.05)
    scene.mesh(*quad(), uv=[[0, 0], [1, 0], [1, 1], [0, 1]], material="floor")
    start, end = numpy.eye(4), numpy.eye(4)
    start[1, 3] = end[1, 3] = 0.5
    end[0, 3] = 0.5
    scene.shape("sphere", material="red", transform=start, end_transform=end, radius=0.5)
    scene.mesh(*quad(1, 3), emission=(5, 5, 5), two_sided=True)
    scene.light("infinite", L=(0.6, 0.7, 1.0))
    return scene


# Everything is lit alike: a radiance of 0.25 in every pixel.
FURNACE = """
Camera "perspective" "float fov" 30
Film "rgb" "integer xresolution" 8 "integer yresolution" 6
Integrator "volpath" "integer maxdepth" 2
WorldBegin
LightSource "infinite" "rgb L" [ 0.25 0.25 0.25 ]
"""
