"""Detected objects: a camera frame of N of them travels as N messages, and is put together again at the other end.

Nothing here has a socket or a clock: times are arguments, in seconds of a clock that never goes back. The messages may
be protobuf payloads or ROS 2 messages; all that is asked of them is the three fields of `Detection`.

The rules of the assembler:

- A frame is delivered once: complete as soon as its last message is there, or partial once its time is up.
- It may be delivered before an earlier one that still waits for a message.
- An id comes back when the sender starts anew at frame 0. It is another frame if it contradicts what is known of the
  first one (another total, another object at an index), or if that was delivered long enough ago.
- Memory is bounded, whatever arrives: frames that are open, objects in a frame, frames that are remembered.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Generic, Protocol, TypeVar


class Detection(Protocol):
    """One object of a frame."""

    frame_id: int
    """Counts the frames of a camera."""
    total_count: int
    """Objects in the frame; 0 in the one message of an empty frame."""
    index: int
    """This object among them, from 0."""


D = TypeVar("D", bound=Detection)


def split(frame_id: int, objects: Sequence[D], new: Callable[[], D]) -> list[D]:
    """The messages of a frame: the objects, numbered in place; of an empty frame one that says so, made by ``new``."""
    messages = list(objects) or [new()]
    for index, message in enumerate(messages):
        message.frame_id, message.total_count, message.index = frame_id, len(objects), index
    return messages


@dataclass(frozen=True, slots=True)
class Frame(Generic[D]):
    """What a camera saw at one moment, as far as it arrived."""

    frame_id: int
    total_count: int
    objects: tuple[D, ...]
    """Those that arrived, in the order of their indices."""
    missing: tuple[int, ...]
    """Indices of those that did not."""

    @property
    def complete(self) -> bool:
        """Whether every object arrived."""
        return not self.missing


@dataclass(frozen=True, slots=True)
class Limits:
    """How long an assembler waits, and how much it holds. Times are in seconds."""

    timeout_s: float = 0.2
    """How long a frame waits for its other messages, from its first."""
    remembered_s: float = 1.0
    """How long a delivered frame's id is its own. Less than a sender needs to start anew; more than the network's
    longest delay."""
    open_frames: int = 16
    """The frame that has waited longest is delivered as it is where one more begins."""
    objects: int = 256
    """Messages of a frame that claims more are refused."""
    remembered_frames: int = 256


@dataclass(slots=True)
class AssemblerCounts:
    """What an assembler did with the messages that it was given."""

    complete: int = 0
    """Frames delivered whole."""
    partial: int = 0
    """Frames delivered with objects missing."""
    duplicates: int = 0
    """Messages that said nothing new."""
    late: int = 0
    """Messages of a frame that had been delivered without them."""
    refused: int = 0
    """Messages that contradict themselves, or belong to a frame of too many objects."""


@dataclass(slots=True)
class _Gathering(Generic[D]):
    """A frame, while its messages arrive and for a while after it was delivered."""

    total_count: int
    until: float
    """When its time is up: to be delivered, or to be forgotten."""
    objects: dict[int, D] = field(default_factory=dict)

    def is_of_another_run(self, message: D) -> bool:
        """Whether a message with this frame's id contradicts it."""
        known = self.objects.get(message.index)
        return message.total_count != self.total_count or (known is not None and known != message)

    @property
    def whole(self) -> bool:
        return len(self.objects) == max(1, self.total_count)

    def frame(self, frame_id: int) -> Frame[D]:
        objects = tuple(self.objects[index] for index in sorted(self.objects)) if self.total_count else ()
        missing = tuple(index for index in range(self.total_count) if index not in self.objects)
        return Frame(frame_id, self.total_count, objects, missing)


class Assembler(Generic[D]):
    """Puts the frames of one sender together again. Not for two threads at once."""

    def __init__(self, limits: Limits | None = None) -> None:
        self._limits = limits or Limits()
        self._open: OrderedDict[int, _Gathering[D]] = OrderedDict()
        self._delivered: OrderedDict[int, _Gathering[D]] = OrderedDict()
        self.counts = AssemblerCounts()

    def add(self, message: D, now: float) -> list[Frame[D]]:
        """Take a message that arrived ``now``; returns the frames that are delivered by it, or by the time."""
        frames = self.expire(now)
        if not self._is_plausible(message):
            self.counts.refused += 1
        elif not self._was_delivered(message):
            frames += self._gather(message, now)
        return frames

    def expire(self, now: float) -> list[Frame[D]]:
        """The frames whose time is up, with what is missing; delivered frames are forgotten after theirs."""
        frames = [self._deliver(frame_id, now) for frame_id in list(_due(self._open, now))]
        for frame_id in list(_due(self._delivered, now)):
            del self._delivered[frame_id]
        return frames

    @property
    def next_deadline(self) -> float | None:
        """When `expire` has a frame to deliver, if nothing arrives until then; None while no frame is open."""
        return next((gathering.until for gathering in self._open.values()), None)

    def _is_plausible(self, message: D) -> bool:
        return message.total_count <= self._limits.objects and message.index < max(1, message.total_count)

    def _was_delivered(self, message: D) -> bool:
        """Whether a message belongs to a frame that is gone; one that contradicts that frame begins another."""
        delivered = self._delivered.get(message.frame_id)
        if delivered is None:
            return False
        if delivered.is_of_another_run(message):
            del self._delivered[message.frame_id]
            return False
        if message.index in delivered.objects:
            self.counts.duplicates += 1
        else:
            self.counts.late += 1
            delivered.objects[message.index] = message
        return True

    def _gather(self, message: D, now: float) -> Iterator[Frame[D]]:
        gathering = self._open.get(message.frame_id)
        if gathering is not None and gathering.is_of_another_run(message):
            yield self._deliver(message.frame_id, now)
            del self._delivered[message.frame_id]
            gathering = None
        if gathering is None:
            if len(self._open) >= self._limits.open_frames:
                yield self._deliver(next(iter(self._open)), now)
            gathering = _Gathering(message.total_count, now + self._limits.timeout_s)
            self._open[message.frame_id] = gathering
        if message.index in gathering.objects:
            self.counts.duplicates += 1
        gathering.objects[message.index] = message
        if gathering.whole:
            yield self._deliver(message.frame_id, now)

    def _deliver(self, frame_id: int, now: float) -> Frame[D]:
        gathering = self._open.pop(frame_id)
        frame = gathering.frame(frame_id)
        if frame.complete:
            self.counts.complete += 1
        else:
            self.counts.partial += 1
        gathering.until = now + self._limits.remembered_s
        self._delivered[frame_id] = gathering
        if len(self._delivered) > self._limits.remembered_frames:
            self._delivered.popitem(last=False)
        return frame


def _due(gatherings: OrderedDict[int, _Gathering[D]], now: float) -> Iterator[int]:
    """The frames whose time is up; they stand in the order of their times."""
    for frame_id, gathering in gatherings.items():
        if gathering.until > now:
            return
        yield frame_id
