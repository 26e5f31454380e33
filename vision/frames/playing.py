"""Recordings as if they were taken now."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace

from roverlink.vision.frames.frame import Frame, FrameSource


def play(source: FrameSource, *, loop: bool = False) -> Iterator[Frame]:
    """A recording's frames at the pace at which they were taken, stamped with the time at which they come.

    None is left out where they are taken slowly. With `loop` it begins anew when it is over, and never ends.
    """
    begin = time.time_ns()
    passed = 0
    while True:
        length = count = 0
        for frame in source:
            stamp = begin + frame.stamp
            time.sleep(max(stamp - time.time_ns(), 0) / 1e9)
            yield replace(frame, stamp=stamp, number=passed + frame.number)
            length, count = frame.stamp + round(1e9 / source.rate), frame.number + 1
        if not loop:
            return
        begin, passed = begin + length, passed + count
