"""Messages of `import covtrace` in a Python that it cannot be used with."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest


class Importing(unittest.TestCase):
    def test_another_python_is_told(self):
        without = "import sys; sys.modules['covtrace._processor'] = None; import covtrace"
        done = subprocess.run([sys.executable, "-c", without], capture_output=True, text=True)
        self.assertIn("the package was built for another Python (_covtrace.", done.stderr)
        self.assertIn(sys.executable, done.stderr)

    def test_a_python_without_numpy_is_told_to_get_it(self):
        with tempfile.TemporaryDirectory() as folder:
            # A finder that does as if there were no numpy, in the words of Python's own.
            hidden = ("import sys\n"
                      "class Hide:\n"
                      "    def find_spec(self, name, path=None, target=None):\n"
                      "        if name == 'numpy': raise ModuleNotFoundError(\"No module named 'numpy'\", name='numpy')\n"
                      "sys.meta_path.insert(0, Hide())\n")
            pathlib.Path(folder, "without.py").write_text(hidden)
            done = subprocess.run([sys.executable, "-c", "import without, covtrace"], capture_output=True, text=True,
                                  env={**os.environ, "PYTHONPATH": f"{folder}:{os.environ.get('PYTHONPATH', '')}"})
        self.assertIn(f"covtrace: No module named 'numpy'; {sys.executable} needs it: pip install numpy", done.stderr)
        self.assertNotIn("another Python", done.stderr)


if __name__ == "__main__":
    unittest.main()
