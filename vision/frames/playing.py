"""Playback of recordings in real time."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace

from roverlink.vision.frames.frame import Frame, FrameSource


def play(source: FrameSource, *, loop: bool = False) -> Iterator[Frame]:
    """Yield the frames of a recording in real time, as they were taken. Their stamps become the current time.

    If the caller is slow, it gets all frames, but late. With `loop`, the recording is repeated without end.
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
