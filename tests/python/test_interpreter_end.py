"""The interpreter ends while threads work in C++: no abort, and work that was asked for before is finished."""

import subprocess
import sys
import tempfile
import textwrap
import unittest

BEGIN = """
import sys, tempfile, threading, time
import covtrace
scene = covtrace.Scene.from_string('''
Film "rgb" "integer xresolution" 64 "integer yresolution" 36
LookAt 0 1 6  0 0 0  0 1 0
Camera "perspective" "float fov" 40
WorldBegin
LightSource "infinite"
Shape "sphere"
''')
def in_daemon(function):
    threading.Thread(target=function, daemon=True).start()
started = threading.Event()
"""


class InterpreterEnd(unittest.TestCase):
    def run_code(self, code, timeout=60):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, "-B", "-c", BEGIN + textwrap.dedent(code)], cwd=folder,
                                  capture_output=True, text=True, timeout=timeout)
        self.assertEqual(done.returncode, 0, done)
        self.assertNotIn("terminate", done.stderr)
        self.assertNotIn("Fatal", done.stderr)
        return done

    def test_render_of_every_method(self):
        for method in ("uniform", "covariance", "hybrid"):
            with self.subTest(method=method):
                self.run_code(f"""
                    in_daemon(lambda: covtrace.render(scene, method={method!r}, spp=1e6,
                                                      progress=lambda p: started.set()))
                    assert started.wait(30)
                """)

    def test_at_once(self):
        self.run_code("in_daemon(lambda: covtrace.render(scene, spp=1e6))")

    def test_several_and_one_after_another(self):
        self.run_code("""
            def again_and_again():
                while True:
                    started.set()
                    covtrace.render(scene, spp=1)
            for _ in range(4):
                in_daemon(again_and_again)
            assert started.wait(30)
            time.sleep(0.3)
        """)

    def test_callbacks_are_waited_for(self):
        done = self.run_code("""
            def slowly(progress):
                started.set()
                for _ in range(20):
                    time.sleep(0.02)
                print("called", flush=True)
            in_daemon(lambda: covtrace.render(scene, spp=1e6, progress=slowly))
            assert started.wait(30)
        """)
        self.assertIn("called", done.stdout)

    def test_files_and_arrays(self):
        self.run_code("""
            image = covtrace.render(scene, spp=1)
            def write():
                while True:
                    image.write("image.exr")
                    covtrace.compare(image, image)
                    started.set()
            def read():
                while True:
                    covtrace.Scene.from_string('WorldBegin Shape "sphere"')
            in_daemon(write)
            in_daemon(read)
            assert started.wait(30)
        """)

    def test_after_the_end_began(self):
        """Late functions of atexit, registered before the package, still have files, but no renders."""
        done = subprocess.run([sys.executable, "-B", "-c", "import atexit\natexit.register(lambda: late())\n" + BEGIN + textwrap.dedent("""
            image = covtrace.render(scene, spp=1)
            folder = tempfile.mkdtemp()
            def late():
                image.write(folder + "/image.exr")
                print(covtrace.Image.read(folder + "/image.exr").rgb.shape)
                try:
                    covtrace.render(scene, spp=1)
                except covtrace.Interrupted as e:
                    print(e)
        """)], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done)
        self.assertIn("(36, 64, 3)\nPython ends: nothing is rendered", done.stdout)


if __name__ == "__main__":
    unittest.main()
