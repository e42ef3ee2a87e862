"""The notebook of the examples in a kernel of its own, as Jupyter runs it."""

import base64
import os
import pathlib
import struct
import unittest

try:
    import ipykernel  # noqa: F401, the kernel's process needs it
    import nbclient
    import nbformat
except ImportError:
    nbclient = None

NOTEBOOK = pathlib.Path(os.environ["COVTRACE_SOURCE"]) / "python/examples/look_around.ipynb"
SIZE = (64, 36)
SECONDS = 120  # for a cell, on a loaded machine
# A long render, with the signal that Jupyter's button "Interrupt the kernel" sends.
INTERRUPTED = """
import os, signal, threading
threading.Timer(1, os.kill, (os.getpid(), signal.SIGINT)).start()
covtrace.render(scene, spp=1_000_000, resolution=SIZE)
"""


def pictures(cell):
    """The PNG files that a cell shows."""
    return [base64.b64decode(o["data"]["image/png"]) for o in cell.outputs if "image/png" in o.get("data", {})]


def texts(cell):
    """The texts that a cell prints and shows."""
    return "".join(o.get("text", "") or o.get("data", {}).get("text/plain", "") for o in cell.outputs)


@unittest.skipUnless(nbclient, "Debian's python3-nbclient and python3-ipykernel are missing: scripts/install-dependencies")
class Notebook(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        notebook = nbformat.read(NOTEBOOK, as_version=4)
        nbformat.validate(notebook)
        for cell in notebook.cells:
            cell.source = cell.source.replace("320x180", "x".join(map(str, SIZE)))
        for name, source in (("interrupted", INTERRUPTED), ("after", "covtrace.render(scene, spp=1, resolution=SIZE)")):
            notebook.cells.append(nbformat.v4.new_code_cell(source, id=name))
        client = nbclient.NotebookClient(notebook, timeout=SECONDS, kernel_name="python3", allow_errors=True)
        cls.cells = {cell.id: cell for cell in notebook.cells}
        with client.setup_kernel():
            for index, cell in enumerate(notebook.cells):
                client.execute_cell(cell, index)

    def test_no_cell_fails(self):
        for name, cell in self.cells.items():
            if name != "interrupted" and cell.cell_type == "code":
                self.assertEqual([o.traceback for o in cell.outputs if o.output_type == "error"], [], name)

    def test_images_are_shown_as_pictures(self):
        for name in ("first", "watch", "cancel", "change", "error", "after"):
            with self.subTest(name):
                shown = pictures(self.cells[name])
                self.assertEqual(len(shown), 1)
                self.assertTrue(shown[0].startswith(b"\x89PNG\r\n"))
                self.assertEqual(struct.unpack(">II", shown[0][16:24]), SIZE)

    def test_a_render_tells_how_far_it_is(self):
        self.assertIn("<covtrace.RunningRender, done>", texts(self.cells["watch"]))

    def test_a_render_is_stopped(self):
        self.assertRegex(texts(self.cells["cancel"]), "complete: False, [1-9]")  # some samples

    def test_a_changed_scene_is_another_picture(self):
        self.assertNotEqual(pictures(self.cells["first"]), pictures(self.cells["change"]))

    def test_the_kernel_can_be_interrupted(self):
        errors = [o.ename for o in self.cells["interrupted"].outputs if o.output_type == "error"]
        self.assertEqual(errors, ["KeyboardInterrupt"])


if __name__ == "__main__":
    unittest.main()
