"""Frames of several cameras as one stream."""

from __future__ import annotations

import heapq
import threading
from collections.abc import Iterator, Sequence

from roverkit.vision.frames.frame import Frame

_JOIN_S = 1.0


def in_order(streams: Sequence[Iterator[Frame]]) -> Iterator[tuple[int, Frame]]:
    """Yield the frames of recordings by their stamps, each with the index of its stream."""

    def stamped(index: int) -> Iterator[tuple[int, int, Frame]]:
        for frame in streams[index]:
            yield frame.stamp, index, frame

    # Stamp and index are never equal for two frames, so that frames are not compared.
    for _, index, frame in heapq.merge(*map(stamped, range(len(streams))), key=lambda entry: entry[:2]):
        yield index, frame


def newest(streams: Sequence[Iterator[Frame]]) -> Iterator[tuple[int, Frame]]:
    """Yield the newest frame of each live stream when it comes, with the index of its stream, until all streams end.

    A thread waits for each stream. If several cameras have a new frame, the oldest frame is first. Raises what a stream
    raises.
    """
    slots = _Slots(len(streams))
    threads = [
        threading.Thread(target=slots.fill, args=(index, stream), name=f"camera-{index}", daemon=True)
        for index, stream in enumerate(streams)
    ]
    for thread in threads:
        thread.start()
    try:
        yield from slots
    finally:
        # A thread that waits for a frame ends when its source is closed.
        slots.close()
        for thread in threads:
            thread.join(_JOIN_S)


class _Slots:
    """The newest frame of each stream."""

    def __init__(self, streams: int) -> None:
        self._news = threading.Condition()
        self._frames: dict[int, Frame] = {}
        self._running = streams
        self._failure: Exception | None = None
        self._closed = False

    def fill(self, index: int, stream: Iterator[Frame]) -> None:
        """Put the frames of a stream into its slot; runs in a thread of its own."""
        try:
            for frame in stream:
                with self._news:
                    if self._closed:
                        return
                    self._frames[index] = frame
                    self._news.notify_all()
        except Exception as error:  # noqa: BLE001  # raised again by the thread that takes the frames
            self._failure = error
        finally:
            with self._news:
                self._running -= 1
                self._news.notify_all()

    def __iter__(self) -> Iterator[tuple[int, Frame]]:
        while True:
            with self._news:
                self._news.wait_for(lambda: self._frames or self._failure or not self._running)
                if self._failure is not None:
                    raise self._failure
                if not self._frames:
                    return
                index = min(self._frames, key=lambda stream: self._frames[stream].stamp)
                frame = self._frames.pop(index)
            yield index, frame

    def close(self) -> None:
        """Take no more frames."""
        with self._news:
            self._closed = True
