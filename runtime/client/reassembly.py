"""Reassembly of frames that a sender has divided into several payloads, such as the objects in one camera image.

Each part says to which frame it belongs (``frame_id``), its place in it (``index``, from 0), and how many parts the
frame has (``total_count``). The rules:

- A frame is complete as soon as all its parts have arrived, in any order. Complete frames come out in rising order of
  their ids. A frame that is not complete when a later one is, is given up: its content is out of date.
- The parts of one frame arrive within a second. What is not complete by then is given up.
- One payload with ``total_count`` 0 and ``index`` 0 is a frame without parts: the camera saw no object.
- A part of a frame that came out or was passed over is late, and ignored. If no other part has arrived for a second, it
  is not late: the sender has started again and counts from the beginning.
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Generic, Protocol, TypeVar

_MOST_PENDING = 16  # frames: enough for all that one network delays, and a bound for what a faulty sender can fill


class Part(Protocol):
    """Payload that is one part of a frame."""

    frame_id: int
    index: int
    total_count: int


F = TypeVar("F", bound=Part)


@dataclass(frozen=True, slots=True)
class Frame(Generic[F]):
    """All parts of one frame."""

    frame_id: int
    parts: tuple[F, ...]
    """Parts in the order of their index; empty if the sender reports a frame without parts."""


@dataclass(slots=True)
class _Pending(Generic[F]):
    """Frame whose parts have not all arrived."""

    total_count: int
    since: float
    """Time in seconds at which its first part arrived."""
    parts: dict[int, F] = field(default_factory=dict)


class Reassembler(Generic[F]):
    """Puts the parts of frames together. Each counter is an attribute."""

    def __init__(self, timeout: float = 1.0) -> None:
        """Give up frames that are not complete ``timeout`` seconds after their first part has arrived."""
        self._timeout = timeout
        self._pending: dict[int, _Pending[F]] = {}
        self._newest: int | None = None
        self._heard = 0.0
        self.complete = 0
        """Frames that came out."""
        self.lost = 0
        """Frames that were given up. Frames of which no part arrived are not known, and not counted."""
        self.late = 0
        """Parts of frames that had come out or were passed over."""
        self.duplicates = 0
        """Parts that had arrived already, of a frame that is not complete."""
        self.invalid = 0
        """Parts whose index does not lie below their total_count."""
        self.restarts = 0
        """Restarts of the sender."""

    def add(self, part: F, now: float | None = None) -> Frame[F] | None:
        """Take a part, and return its frame if the frame is now complete.

        ``now`` is the time of arrival in seconds of a steady clock; the default is that of this computer.
        """
        now = time.monotonic() if now is None else now
        if part.index >= max(part.total_count, 1):
            self.invalid += 1
            return None
        if self._is_late(part.frame_id, now):
            self.late += 1
            return None
        self._heard = now
        self._give_up([frame for frame, pending in self._pending.items() if now - pending.since >= self._timeout])
        pending = self._frame_of(part, now)
        self.duplicates += part.index in pending.parts
        if part.total_count:
            pending.parts[part.index] = part
        if len(pending.parts) < pending.total_count:
            return None
        return self._completed(part.frame_id)

    def _is_late(self, frame_id: int, now: float) -> bool:
        """Return true for a part of the past. If the sender has started again, forget the past."""
        if self._newest is None or frame_id > self._newest:
            return False
        if now - self._heard < self._timeout:
            return True
        self._give_up(list(self._pending))
        self._newest = None
        self.restarts += 1
        return False

    def _frame_of(self, part: F, now: float) -> _Pending[F]:
        pending = self._pending.get(part.frame_id)
        if pending is not None and pending.total_count == part.total_count:
            return pending
        # Two parts that disagree belong to two runs of the sender, or one is faulty: the newer one is right.
        self._give_up([part.frame_id] if pending else [])
        self._give_up(list(self._pending)[: 1 - _MOST_PENDING])
        pending = self._pending[part.frame_id] = _Pending(part.total_count, now)
        return pending

    def _completed(self, frame_id: int) -> Frame[F]:
        parts = self._pending.pop(frame_id).parts
        self._give_up([other for other in self._pending if other < frame_id])
        self._newest = frame_id
        self.complete += 1
        return Frame(frame_id, tuple(part for _, part in sorted(parts.items())))

    def _give_up(self, frames: Iterable[int]) -> None:
        for frame in frames:
            del self._pending[frame]
            self.lost += 1
