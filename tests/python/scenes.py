"""Small scenes for the tests of the package."""

import base64
import json

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


# A scene that shows its sky alone.
SKY = """
Camera "perspective" "float fov" 30
Film "rgb" "integer xresolution" 8 "integer yresolution" 6
WorldBegin
LightSource "infinite" "rgb L" [3 3 3]
AttributeBegin
  Translate 0 0 -9
  Shape "sphere" "float radius" 1
AttributeEnd
"""

# A ball on a floor under a lamp, out of focus.
LIT = """
LookAt 0 1 6  0 0 0  0 1 0
Camera "perspective" "float fov" 40 "float lensradius" 0.1 "float focaldistance" 5
Film "rgb" "integer xresolution" 24 "integer yresolution" 16
WorldBegin
LightSource "infinite" "rgb L" [.1 .2 .3]
AttributeBegin
  AreaLightSource "diffuse" "rgb L" [3 3 3]
  Translate 0 3 0
  Shape "sphere" "float radius" 0.5
AttributeEnd
Material "diffuse" "rgb reflectance" [.5 .4 .3]
Shape "sphere" "float radius" 1
Shape "trianglemesh" "point3 P" [-4 -1 -4  4 -1 -4  4 -1 4  -4 -1 4] "integer indices" [0 2 1  0 3 2]
"""

# A scene that is lit alike everywhere: a radiance of 0.25 in every pixel.
FURNACE = """
Camera "perspective" "float fov" 30
Film "rgb" "integer xresolution" 8 "integer yresolution" 6
Integrator "volpath" "integer maxdepth" 2
WorldBegin
LightSource "infinite" "rgb L" [ 0.25 0.25 0.25 ]
"""


def gltf():
    """The text of a glTF file: a shining square one metre wide moves by two metres to the right in the
    first second, before a camera that sees four metres around it."""
    corners = numpy.array([[-0.5, -0.5, 0], [0.5, -0.5, 0], [0.5, 0.5, 0], [-0.5, 0.5, 0]], dtype="<f4")
    indices = numpy.array([0, 1, 2, 0, 2, 3], dtype="<u4")
    times, places = numpy.array([0, 1], dtype="<f4"), numpy.array([[-1, 0, 0], [1, 0, 0]], dtype="<f4")
    arrays = (corners, indices, times, places)
    data = b"".join(a.tobytes() for a in arrays)
    starts = numpy.cumsum([0] + [a.nbytes for a in arrays])
    views = [{"buffer": 0, "byteOffset": int(start), "byteLength": a.nbytes} for start, a in zip(starts, arrays)]

    def accessor(view, array):
        return {"bufferView": view, "componentType": 5125 if array is indices else 5126, "count": len(array),
                "type": "VEC3" if array.ndim == 2 else "SCALAR"}

    return json.dumps({
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": len(data),
                     "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
        "bufferViews": views, "accessors": [accessor(i, a) for i, a in enumerate(arrays)],
        "materials": [{"emissiveFactor": [1, 1, 1], "doubleSided": True,
                       "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 2}}}],
        "extensionsUsed": ["KHR_materials_emissive_strength"],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "cameras": [{"type": "orthographic", "orthographic": {"xmag": 2, "ymag": 1, "znear": 0.1, "zfar": 10}}],
        "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, 3]}],
        "animations": [{"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
                        "samplers": [{"input": 2, "output": 3}]}]})
