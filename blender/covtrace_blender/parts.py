"""Long arrays worked on part by part, by all processors."""

import concurrent.futures
import os

PART = 16384  # whose arrays stay in the caches, and are long enough that threads seldom wait for the interpreter


def by_parts(work, count, part=PART):
    """Calls `work(first, end)` for consecutive ranges of 0 to `count`, from several threads. numpy works on arrays at the same time;
    all else, Blender's data too, is seen by one thread at a time."""
    ranges = [(first, min(first + part, count)) for first in range(0, count, part)]
    if len(ranges) < 2:
        for first, end in ranges:
            work(first, end)
        return
    with concurrent.futures.ThreadPoolExecutor(min(os.cpu_count() or 1, len(ranges))) as threads:
        for _ in threads.map(lambda r: work(*r), ranges):
            pass
