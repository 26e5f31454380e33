"""Functions that get a copy of what passes a bridge."""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from typing import Protocol, runtime_checkable


class Tap(Protocol):
    """Function that takes messages of one topic, or datagrams, oldest first. It must return at once."""

    def __call__(self, messages: Sequence[bytes], arrived: Sequence[int] = ()) -> None:
        """Take messages; ``arrived`` are their times in nanoseconds of the monotonic clock, empty for now."""


@runtime_checkable
class NewestTap(Tap, Protocol):
    """Tap for which the newest message is enough."""

    newest_is_enough: bool


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
        The first place is ``offset``.
        """


class BlockFile(Protocol):
    """File that takes blocks."""

    def put(self, block: Block) -> None:
        """Take a block. Return at once."""


@runtime_checkable
class FileTap(Tap, Protocol):
    """Tap whose messages go to a channel of a file."""

    file: BlockFile
    channel: int
