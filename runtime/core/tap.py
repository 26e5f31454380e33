"""Functions that get a copy of what passes a bridge."""

from __future__ import annotations

import threading
from array import array
from collections.abc import Callable, Sequence
from typing import Protocol, runtime_checkable


class Tap(Protocol):
    """Function that takes messages of one topic, or datagrams, oldest first. It must return at once."""

    def __call__(self, messages: Sequence[bytes], arrived: Sequence[int] = ()) -> None:
        """Take messages; ``arrived`` are their times in nanoseconds of the monotonic clock, empty for now."""


class Sources:
    """Functions that pass on what has come since their last call.

    Whoever takes messages at times of its own calls them first. Safe to use from several threads.
    """

    def __init__(self) -> None:
        self._all: tuple[Callable[[], object], ...] = ()
        self._lock = threading.Lock()

    def add(self, source: Callable[[], object]) -> None:
        """Call ``source`` from now on."""
        with self._lock:
            self._all = (*self._all, source)

    def remove(self, source: Callable[[], object]) -> None:
        """Call ``source`` no longer."""
        with self._lock:
            self._all = tuple(one for one in self._all if one != source)

    def __call__(self) -> None:
        """Call all functions."""
        for source in self._all:
            source()


@runtime_checkable
class NewestTap(Tap, Protocol):
    """Tap for which the newest message is enough."""

    sources: Sources


class Block(Protocol):
    """Messages of several channels of a file, which the native core turns into the file's records at once."""

    @property
    def count(self) -> int:
        """Number of messages."""

    def records(
        self, log_time: int, publish_time: int, offset: int
    ) -> tuple[bytearray, Sequence[tuple[int, array[int]]]]:
        """Return Message records of MCAP; the times are what to add to those of the monotonic clock, in nanoseconds.

        The second value has each channel's number in the file, with a log time and a place for each of its messages.
        The first place is ``offset``, and the times of a channel rise.
        """


class BlockFile(Protocol):
    """File that takes blocks."""

    sources: Sources

    def put(self, block: Block) -> None:
        """Take a block. Return at once."""


@runtime_checkable
class FileTap(Tap, Protocol):
    """Tap whose messages go to a channel of a file."""

    file: BlockFile
    channel: int
