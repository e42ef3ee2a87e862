"""Images of a scene that changes, by the program beside Blender: coarse and at once, then ever finer. Knows nothing of Blender."""

import os
import subprocess
import threading
import time
import weakref

import numpy as np

from . import layers
from .tev_receiver import TevReceiver

COARSE = 4  # the first image has this share of the pixels of a row
COARSE_SAMPLES = 4
SECONDS_TO_WAIT = 0.05

_all = weakref.WeakSet()


def stop_all():
    """Ends the programs of all sessions."""
    for session in list(_all):
        session.stop()


class View:
    """A view to show: `text` before a scene's WorldBegin, its file `content` in `folder`, the image's size in pixels; `options`
    of the program for the fine image. `keep`: what has to live as long as the files do."""

    def __init__(self, text, folder, content, size, options, keep=None):
        self.text, self.folder, self.content, self.size, self.options, self.keep = text, folder, content, size, options, keep


class PreviewSession:
    """Renders the view that was asked for last. A coarse image is always finished, so that something is seen while views
    change faster than images come; a fine one ends where there is a newer view.

    `image`: (height, width, 4) float32, rows from the bottom, None before the first; `version` counts them; `failure`: the
    program's last message where it failed; `is_busy`: whether there is more to come.
    """

    def __init__(self, program):
        self.program = program
        self.image, self.version, self.failure, self.is_busy = None, 0, "", False
        self._changed, self._wanted, self._is_stopped = threading.Condition(), None, False
        self._process = None
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()
        _all.add(self)

    def show(self, view):
        """Asks for an image of a View and returns at once."""
        with self._changed:
            self._wanted, self.is_busy = view, True
            self._changed.notify()

    def is_waiting(self):
        """Whether a view is asked for whose coarse image has not been begun."""
        return self._wanted is not None

    def stop(self):
        """Ends the program and the session."""
        with self._changed:
            self._is_stopped = True
            if self._process is not None:
                self._process.kill()
            self._changed.notify()
        if threading.current_thread() is not self._thread:
            self._thread.join(5)

    def _run(self):
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._wanted or self._is_stopped)
                if self._is_stopped:
                    return
                view, self._wanted = self._wanted, None
            try:
                self._render(view)
            except Exception as problem:  # the session goes on, whatever is wrong with one image
                self.failure = str(problem) or type(problem).__name__
                self._set(self.image)
            with self._changed:
                self.is_busy = self._wanted is not None

    def _render(self, view):
        file = os.path.join(view.folder, "view.pbrt")
        with open(file, "w", encoding="utf-8") as out:
            out.write(f'{view.text}Include "{view.content}"\n')
        width, height = (max(1, n // COARSE) for n in view.size)
        coarse = ["--resolution", f"{width}x{height}", "--method", "uniform", "--spp", str(COARSE_SAMPLES)]
        if self._image_of(file, coarse, ends_early=False):
            self._image_of(file, view.options, ends_early=True)

    def _image_of(self, file, options, ends_early):
        """Shows images of the scene while it renders, and the last one; False where there is none."""
        image = file + ".exr"
        receiver = TevReceiver()
        is_ended = False
        command = [self.program, "render", file, "-o", image, "--layers", "none", "--quiet", "--tev", receiver.address, *options]
        try:
            with self._changed:
                if self._is_stopped:
                    return False
                self._process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                                 stderr=subprocess.PIPE, text=True, errors="replace")
            while self._process.poll() is None:
                before = time.monotonic()
                shown = receiver.receive(SECONDS_TO_WAIT)
                if shown is not None:
                    self._set(shown)
                elif time.monotonic() - before < SECONDS_TO_WAIT / 2:
                    time.sleep(SECONDS_TO_WAIT)  # the program has ended the connection and not yet itself
                if ends_early and self._wanted is not None:
                    is_ended = True
                    self._process.kill()
            messages = self._process.stderr.read()
            self._process.stderr.close()
            code = self._process.wait()
        finally:
            receiver.close()
            with self._changed:
                process, self._process = self._process, None
            if process is not None and process.poll() is None:  # nobody knows of it any more
                process.kill()
                process.wait()
                process.stderr.close()
        if code != 0:
            if not is_ended and not self._is_stopped:
                said = messages.strip().splitlines()
                self.failure = said[-1] if said else f"covtrace was ended by signal {-code}" if code < 0 else f"exit code {code}"
                self._set(self.image)
            return False
        self.failure = ""
        channels = layers.read(image)
        channels.setdefault("A", np.ones_like(channels["R"]))
        self._set(layers.pixels(channels, "RGBA"))
        return True

    def _set(self, image):
        self.image = image
        self.version += 1
