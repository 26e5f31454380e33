"""Playback of recordings in real time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from roverkit.vision.frames.frame import Frame, FrameSource
from roverlink.runtime.ros_time.clock import SYSTEM_CLOCK, Clock


def play(source: FrameSource, *, loop: bool = False, clock: Clock = SYSTEM_CLOCK) -> Iterator[Frame]:
    """Yield the frames of a recording in real time, as they were taken. Their stamps become the time of a clock.

    If the caller is slow, it gets all frames, but late. With `loop`, the recording is repeated without end.
    """
    begin = shown = clock.now()
    passed = 0
    while True:
        length = count = 0
        for frame in source:
            clock.sleep_until(begin + frame.stamp, shown)
            begin = min(begin, clock.now() - frame.stamp)  # earlier if the clock has jumped back
            shown = begin + frame.stamp
            yield replace(frame, stamp=shown, number=passed + frame.number)
            length, count = frame.stamp + round(1e9 / source.rate), frame.number + 1
        if not loop:
            return
        begin, passed = begin + length, passed + count
