"""Playback of timed messages in the pace of a recording, with pause and seek. It does not wait itself."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator

from roverlink.runtime.recording.replaying import Timed

Source = Callable[[int], Iterator[Timed]]
"""Function that returns the messages from a time, in nanoseconds since 1970."""


class Playback:
    """Playback of the messages of a recording. All times are nanoseconds since 1970."""

    def __init__(
        self,
        source: Source,
        bounds: tuple[int, int],
        start: int,
        speed: float,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Begin with the first message at ``start`` or later.

        ``bounds`` are the first and the last time of the recording. ``clock`` returns seconds.
        """
        self._source, self._bounds, self._start, self._speed, self._clock = source, bounds, start, speed, clock
        self._at, self._since = start, clock()  # the position was `_at` when the clock showed `_since`
        self._messages: Iterator[Timed] = iter(())
        self._next: Timed | None = None
        self.paused = False
        """True while the playback stands still."""
        self.restart()

    @property
    def position(self) -> int:
        """Present time of the playback."""
        return min(self._at + self._elapsed(), self._bounds[1])

    def restart(self) -> None:
        """Begin again with the first message."""
        self._start_at(self._start)
        if self._next is not None:
            # The first message is due at once: other topics may begin earlier than those that are replayed.
            self._at = self._next.time

    def toggle_pause(self) -> None:
        """Pause the playback, or continue it."""
        # Not `position`: if the playback is late, it remains as late as it is.
        self._at, self._since = self._at + self._elapsed(), self._clock()
        self.paused = not self.paused

    def seek(self, seconds: float) -> None:
        """Continue with the messages so many seconds of the recording later, or earlier if the number is negative."""
        self._start_at(max(self._bounds[0], min(self._bounds[1], self.position + int(seconds * 1e9))))

    def due(self) -> float | None:
        """Return the seconds until the next message, at most 0 if it is due; infinity in a pause; None at the end."""
        if self._next is None:
            return None
        if self.paused:
            return math.inf
        # Each message is due relative to the start, so that the error of a wait does not add up.
        return (self._next.time - self._at) / 1e9 / self._speed - (self._clock() - self._since)

    def take(self) -> Timed:
        """Return the next message, and go on to the one after it. Call it only if `due` says that there is one."""
        message = self._next
        if message is None:
            raise ValueError("the playback is at its end")
        self._next = next(self._messages, None)
        return message

    def _start_at(self, position: int) -> None:
        self._at, self._since = position, self._clock()
        self._messages = self._source(position)
        self._next = next(self._messages, None)

    def _elapsed(self) -> int:
        return 0 if self.paused else int((self._clock() - self._since) * self._speed * 1e9)
