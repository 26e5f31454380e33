"""One of the two files of a recording, with a queue of messages that wait to be written to it."""

from __future__ import annotations

import threading
from collections import Counter, deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

from roverlink.runtime.core.tap import Block, Sources, Tap
from roverlink.runtime.recording import file_names
from roverlink.runtime.recording.clocks import ClockJump, RunClock
from roverlink.runtime.recording.mcap_file import CLOCK_JUMP, Channel, Entry, McapFile

QUEUE = 65_536
"""Default number of messages that may wait for each file; at 10,000 a second, more than six seconds."""
_MUCH = 0.25  # part of them from which on they are written earlier


@dataclass(frozen=True, slots=True)
class Settings:
    """Options of a recording."""

    compression: str = "zstd"
    """``zstd``, ``lz4`` or ``none``."""
    rotate_bytes: int | None = None
    """Size in bytes at which a file ends and the next part begins; None for one file."""
    queue: int = QUEUE
    """Number of messages that may wait for each file."""


class _WaitingBlock(NamedTuple):
    block: Block
    publish_time: int
    """Nanoseconds to add to the monotonic clock, for what the computer's clock showed."""


class _ChannelTap:
    """Function that the bridge's threads call with the messages of a channel."""

    def __init__(self, file: QueuedFile, channel: int, clock: RunClock) -> None:
        self.file, self.channel = file, channel
        self._waiting, self._start, (self._monotonic, self._wall) = file.waiting, clock.start, clock.clocks

    def __call__(self, messages: Sequence[bytes], arrived: Sequence[int] = ()) -> None:
        # Checked once for each batch, so the queue may exceed the limit by one batch.
        if self.file.is_full:
            self.file.lost[self.channel] += len(messages)
            return
        now, shown = self._monotonic(), self._wall()
        for message, at in zip(messages, arrived or (now,) * len(messages)):
            self._waiting.append((self._start + at, shown + at - now, self.channel, message))


class QueuedFile:
    """One of the two files of a recording, split into parts if it is large, with a queue of messages that wait.

    The bridge's threads append messages to the queue, and the recorder's thread takes them from it. No lock is needed
    for that, because the operations of `deque` are safe in several threads.
    """

    def __init__(
        self,
        path: Path,
        kind: str,
        settings: Settings,
        metadata: Mapping[str, str],
        clock: RunClock,
        sort: Callable[[Entry], Entry] | None = None,
    ) -> None:
        """Create the first part; ``kind`` is `file_names.TOPICS` or `file_names.DATAGRAMS`.

        ``sort`` may move a message to another channel: it returns the message with its right channel number. It is
        called on the recorder's thread.
        """
        self._path, self._kind, self._settings, self._metadata, self._sort = path, kind, settings, metadata, sort
        self._clock = clock
        self.sources = Sources()
        self.wake: Callable[[], None] = lambda: None
        """Function that lets the file be written earlier, because much waits."""
        self._jumps: list[ClockJump] = []
        self.limit = settings.queue
        self.waiting: deque[Entry | _WaitingBlock] = deque()
        self._in_blocks = 0  # messages of blocks that wait, less one for each block
        self._blocks_lock = threading.Lock()
        self.lost: Counter[int] = Counter()  # by channel, each written by one thread; 0 counts `give_up`, -1 blocks
        self.channels: list[Channel] = []
        self._declared = 0
        self._parts = 0
        self._ended = False
        self.counts: Counter[int] = Counter()
        self._bytes_before = 0
        self.file = self._next_file()

    def channel(self, topic: str, encoding: str, **schema: Any) -> Tap:
        """Add a channel, and return the function that the bridge's threads call with the messages of the channel."""
        channel = Channel(len(self.channels) + 1, topic, encoding, **schema)
        self.channels.append(channel)
        return _ChannelTap(self, channel.id, self._clock)

    @property
    def is_full(self) -> bool:
        """True if so many messages wait that the next ones are lost."""
        return self.waiting_messages >= self.limit

    @property
    def waiting_messages(self) -> int:
        """Number of messages that wait to be written."""
        return len(self.waiting) + self._in_blocks

    def put(self, block: Block) -> None:
        """Append messages from the native core to the queue."""
        monotonic, wall = self._clock.clocks
        with self._blocks_lock:
            if self.is_full:
                self.lost[-1] += block.count
                return
            self._in_blocks += block.count - 1
            self.waiting.append(_WaitingBlock(block, wall() - monotonic()))
        if self.waiting_messages > self.limit * _MUCH:
            self.wake()

    def take(self) -> int:
        """Write the waiting messages to the file. If the file is then large enough, begin the next part.

        Return how many of them had come one by one, and not in blocks.
        """
        self.sources()
        # Only as many as wait now: a fast producer must not keep this loop going forever.
        count = len(self.waiting)
        if not count:
            return 0
        # Before the messages leave the queue: if the disk is full, `give_up` counts those that are in it.
        while self._declared < len(self.channels):
            self.file.add_channel(self.channels[self._declared])
            self._declared += 1
        taken, one_by_one = [self._next_waiting() for _ in range(count)], 0
        for is_block, run in groupby(taken, lambda entry: isinstance(entry, _WaitingBlock)):
            entries = [*run]
            if is_block:
                for block, publish_time in entries:
                    self.file.add_block(block, self._clock.start, publish_time)
            else:
                one_by_one += len(entries)
                self.file.add(entries if self._sort is None else map(self._sort, entries))
        if self._settings.rotate_bytes is not None and self.file.size >= self._settings.rotate_bytes:
            self.finish()
            ended = self.file.size
            self.file, self._ended = self._next_file(), False
            self._bytes_before += ended
        return one_by_one

    def _next_waiting(self) -> Any:
        entry = self.waiting.popleft()
        if isinstance(entry, _WaitingBlock):
            with self._blocks_lock:
                self._in_blocks -= entry.block.count - 1
        return entry

    def jumped(self, jump: ClockJump) -> None:
        """Write down that the computer's clock was set; later parts of the recording say it, too. Raises `OSError`."""
        self._jumps.append(jump)
        self.file.add_metadata(CLOCK_JUMP, jump.facts())

    def finish(self) -> None:
        """Write the summary and close the file. A second call does nothing."""
        if not self._ended:
            self.file.finish()
            self._end()

    def give_up(self) -> None:
        """Close the file after an error, such as a full disk. The waiting messages are lost, and later ones too."""
        self.limit = 0  # from now on every message is dropped and counted
        while self.waiting:  # one by one: another thread may still be adding the batch that it has begun
            entry = self._next_waiting()
            self.lost[0] += entry.block.count if isinstance(entry, _WaitingBlock) else 1
        if not self._ended:
            self.lost[0] += self.file.finish_anyway()
            self._end()

    @property
    def lost_messages(self) -> int:
        """Number of messages that came and are not in the file."""
        # A batch that another thread had begun to add when the file was given up stays in the queue.
        return self.lost.total() + (0 if self.limit else self.waiting_messages)

    def delete(self) -> None:
        """Close the current part and delete it."""
        self.file.close()
        self.file.path.unlink()

    def _end(self) -> None:
        self._ended = True
        self.counts.update(self.file.counts)

    @property
    def bytes(self) -> int:
        """Number of bytes on disk, in all parts."""
        return self._bytes_before + self.file.size

    def _next_file(self) -> McapFile:
        path = file_names.part_of(self._path, self._kind, self._parts)
        self._parts += 1
        self._declared = 0
        # The profile tells rosbag2 that all channels are ROS 2's; the datagrams' file has none.
        profile = "ros2" if self._kind == file_names.TOPICS else ""
        file = McapFile(path, profile, self._settings.compression, self._metadata)
        for jump in self._jumps:
            file.add_metadata(CLOCK_JUMP, jump.facts())
        return file
