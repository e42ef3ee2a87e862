"""Renders that run beside the program that started them."""

from __future__ import annotations

import asyncio
import inspect
import os
import threading
from collections.abc import Callable, Generator
from concurrent.futures import Future
from typing import Any

from .arguments import refuse_unknown
from .builder import SceneBuilder
from .closed import Hinting
from .image import Image
from .progress import Progress
from .rendering import render
from .scene import Scene
from .scene_warnings import Place, place_of_caller, place_of_thread


class RunningRender(Hinting):
    """A render in a thread of its own, as `start` returns it.

    progress: the latest `Progress`, None before the first; its `fraction` is 1 once a complete image is there.
    image: the latest image: of the samples so far, None before the first round has ended; at last
        the delivered one.

    In a coroutine, `await` gives what `result` does.
    """

    _other_names = {**dict.fromkeys(("wait", "join", "get"), "result() waits for the image"),
                    **dict.fromkeys(("stop", "kill", "abort", "terminate"), "cancel() ends it")}

    progress: Progress | None
    image: Image | None

    def __init__(self, scene: str | os.PathLike[str] | Scene | SceneBuilder,
                 options: dict[str, Any]) -> None:
        self.progress = None
        self.image = None
        self._cancel = threading.Event()
        self._future: Future[Image] = Future()
        self._future.set_running_or_notify_cancel()
        self._observers = {name: options.pop(name, None) for name in ("progress", "preview")}
        thread = threading.Thread(target=self._run, args=(scene, options, place_of_caller()),
                                  daemon=True, name="covtrace render")
        thread.start()

    def _run(self, scene: Any, options: dict[str, Any], begun_at: Place) -> None:
        place_of_thread(begun_at)
        try:
            image = render(scene, progress=self._note_progress, preview=self._note_image,
                           cancel=self._cancel, **options)
        except BaseException as error:  # whatever it is belongs to who asks for the result
            self._future.set_exception(error)
            return
        self.image = image
        if self.progress is not None and image.complete:
            done = image.statistics  # the last report may have been long before the end
            self.progress = self.progress._replace(fraction=1.0, samples_per_pixel=done["spp"], elapsed=done["seconds_total"],
                                                   remaining=0.0)
        self._future.set_result(image)

    def _note_progress(self, progress: Progress) -> None:
        self.progress = progress
        if self._observers["progress"]:
            self._observers["progress"](progress)

    def _note_image(self, image: Image) -> None:
        self.image = image
        if self._observers["preview"]:
            self._observers["preview"](image)

    def cancel(self) -> None:
        """Ends the render soon. Its result is the image that is there then, `complete` being False."""
        self._cancel.set()

    def done(self) -> bool:
        """Whether the result, or an error, is there."""
        return self._future.done()

    def result(self, timeout: float | None = None) -> Image:
        """Waits for the image. Raises what `render` raises, and `TimeoutError` after `timeout`
        seconds, while the render goes on."""
        return self._future.result(timeout)

    def add_done_callback(self, function: Callable[[RunningRender], Any]) -> None:
        """Calls `function` with this object once it is done: in the render's thread, or at once."""
        self._future.add_done_callback(lambda _: function(self))

    def __await__(self) -> Generator[Any, None, Image]:
        return self._wait().__await__()

    async def _wait(self) -> Image:
        try:
            return await asyncio.wrap_future(self._future)
        except asyncio.CancelledError:  # nobody waits for the image any more
            self.cancel()
            raise

    def __repr__(self) -> str:
        state = "done" if self.done() else "not begun" if self.progress is None else (
            f"{self.progress.phase}, {100 * self.progress.fraction:.0f} %")
        return f"<covtrace.RunningRender, {state}>"


def start(scene: str | os.PathLike[str] | Scene | SceneBuilder, **options: Any) -> RunningRender:
    """Begins a render and returns at once. scene and options are those of `render`, but for `cancel`,
    which the object has; `progress` and `preview` are called in the render's thread."""
    if "cancel" in options:
        raise TypeError("start() takes no 'cancel'; call cancel() of what it returns")
    refuse_unknown("start", options, [name for name in inspect.signature(render).parameters if name != "scene"])
    return RunningRender(scene, options)
