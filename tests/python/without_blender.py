"""The package of the Blender add-on without Blender: its beginning is not run, and what its modules ask of Blender, the version
and colours between its spaces, has stand-ins. To be imported before the package."""

import os
import pathlib
import sys
import types


class Rec709Color(tuple):
    """Blender's Color where the scene's linear space is Rec.709."""

    def from_rec709_linear_to_scene_linear(self):
        return self

    from_scene_linear_to_rec709_linear = from_rec709_linear_to_scene_linear


package = types.ModuleType("covtrace_blender")
package.__path__ = [str(pathlib.Path(os.environ["COVTRACE_SOURCE"], "blender/covtrace_blender"))]
sys.modules["covtrace_blender"] = package
sys.modules["bpy"] = types.SimpleNamespace(app=types.SimpleNamespace(version=(4, 5, 0)))
sys.modules["mathutils"] = types.SimpleNamespace(Color=Rec709Color)
