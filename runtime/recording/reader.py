"""Reader of recordings: their contents, and their messages in order of time.

If the recording program was killed, a recording has no summary and may end within a record; then it is read up to the
last complete record. The reader also accepts MCAP files of other programs, with or without chunks.

A recording can come from a stranger, and 64 KB of compressed data can become gigabytes. Therefore the size of a record,
of a chunk, and of all descriptions of topics is limited.
"""

from __future__ import annotations

import contextlib
import heapq
import itertools
import struct
import zlib
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from io import BytesIO
from operator import attrgetter, itemgetter
from pathlib import Path
from typing import IO, NamedTuple

from roverlink.bounded_files import open_regular
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.recording import file_names, mcap_file
from roverlink.runtime.recording.clocks import ClockJump
from roverlink.runtime.recording.mcap_file import Channel, McapError, ReadDataStream, lz4, records, zstandard
from roverlink.runtime.recording.mcap_file import Opcode as Op

# A record is an opcode, a length and its content; all integers are little endian (MCAP specification, Serialization).
_RECORD = struct.Struct("<BQ")
_MESSAGE = struct.Struct("<HIQQ")
_CHUNK_TIMES = struct.Struct("<QQ")
_LARGEST = 64 << 20  # bytes; recorders write chunks of 1 to 4 MB, and the largest images have 50 MB
_DESCRIPTIONS = (Op.SCHEMA, Op.CHANNEL)
_FACTS = (*_DESCRIPTIONS, Op.HEADER, Op.METADATA, Op.STATISTICS)


class Recorded(NamedTuple):
    """Message in a recording, with its times and its channel."""

    time: int
    """Steady time in nanoseconds since 1970, for order and pace; see `clocks`."""
    wall: int
    """Time that the computer's clock showed, in nanoseconds since 1970."""
    channel: Channel
    data: bytes


@dataclass
class Contents:
    """Summary of one file of a recording."""

    profile: str = ""
    metadata: dict[str, str] = field(default_factory=dict)
    """Metadata that the recorder wrote; empty for files of other programs."""
    channels: dict[int, Channel] = field(default_factory=dict)
    counts: Counter[int] = field(default_factory=Counter)
    """Number of messages by channel."""
    jumps: set[ClockJump] = field(default_factory=set)
    """Changes of the computer's clock during the recording."""
    start: int = 0
    """Time of the first message in nanoseconds since 1970; 0 if there is no message."""
    end: int = 0
    """Time of the last message in nanoseconds since 1970; 0 if there is no message."""
    complete: bool = False
    """False if the file has no summary: the program that writes it was killed or is still writing."""


class RecordingFile:
    """One MCAP file of a recording."""

    def __init__(self, path: Path) -> None:
        """Check that the file begins like an MCAP file. Raises `SetupError` if not, or if the file is not readable."""
        self.path = path
        self._described, self._sizes = 0, dict[tuple[int, int], int]()
        try:
            with open_regular(path) as file:
                start = file.read(len(mcap_file.MAGIC))
        except OSError as error:
            raise SetupError(f"{path}: cannot read the file: {error.strerror}") from error
        if start != mcap_file.MAGIC:
            raise SetupError(f"{path}: not an MCAP file")

    @contextlib.contextmanager
    def _open(self) -> Iterator[IO[bytes]]:
        """Open the file for the block. If the block finds damaged content, raise `SetupError`."""
        try:
            with open_regular(self.path) as file:
                yield file
        # The libraries of MCAP, zstd and LZ4 (RuntimeError) let errors of Python's conversions through.
        except (McapError, zstandard.ZstdError, RuntimeError, struct.error, ValueError, OverflowError) as error:
            raise SetupError(f"{self.path}: the file is damaged: {error or type(error).__name__}") from error
        except OSError as error:
            raise SetupError(f"{self.path}: cannot read the file: {error.strerror}") from error

    @property
    def _size(self) -> int:
        return self.path.stat().st_size

    @cached_property
    def contents(self) -> Contents:
        """Summary of the file: its channels, the numbers of messages, and the times of the first and last message.

        If the file has no summary record, all its messages are read to make the summary.
        """
        contents = Contents()
        with self._open() as file:
            for opcode, body in _records(file, self._size, _FACTS):
                self._note(opcode, body, contents)
        if not contents.complete:
            for message in self._scan(contents):
                contents.counts[message.channel.id] += 1
                contents.start = min(contents.start or message.time, message.time)
                contents.end = max(contents.end, message.time)
        return contents

    def messages(self, since: int = 0) -> Iterator[Recorded]:
        """Yield every message from the time ``since``; the messages of one chunk are in order of time.

        Raises `SetupError` if the file is damaged.
        """
        if not since:
            return self._scan(Contents())
        # The chunks that are skipped may declare channels for later ones, so all channels are read first.
        found = self._scan(Contents(channels=dict(self.contents.channels)), since)
        return (message for message in found if message.time >= since)

    def _scan(self, contents: Contents, since: int = 0) -> Iterator[Recorded]:
        with self._open() as file:
            for opcode, body in _records(file, self._size, (*_FACTS, Op.CHUNK, Op.MESSAGE), since):
                if opcode == Op.CHUNK:
                    yield from self._chunk(records.Chunk.read(_stream(body)), contents)
                elif opcode == Op.MESSAGE:
                    yield self._message(body, contents)
                else:
                    self._note(opcode, body, contents)

    def _chunk(self, chunk: records.Chunk, contents: Contents) -> list[Recorded]:
        found: list[Recorded] = []
        plain = _plain(chunk)
        for opcode, body in _records(BytesIO(plain), len(plain), (*_DESCRIPTIONS, Op.MESSAGE)):
            if opcode == Op.MESSAGE:
                found.append(self._message(body, contents))
            else:
                self._note(opcode, body, contents)
        # Two threads fill a chunk, so its messages are only nearly in order.
        return sorted(found, key=itemgetter(0))

    def _message(self, body: bytes, contents: Contents) -> Recorded:
        channel, _, time, wall = _MESSAGE.unpack_from(body)
        if channel not in contents.channels:
            raise McapError(f"a message has the unknown channel {channel}")
        return Recorded(time, wall, contents.channels[channel], body[_MESSAGE.size :])

    def _note(self, opcode: int, body: bytes, contents: Contents) -> None:
        """Store the information of a record that is not a message in ``contents``."""
        if opcode == Op.HEADER:
            contents.profile = records.Header.read(_stream(body)).profile
        elif opcode == Op.SCHEMA:
            schema = records.Schema.read(_stream(body))
            self._count(opcode, schema.id, body)
            self._schemas[schema.id] = schema
        elif opcode == Op.CHANNEL:
            channel = _channel(records.Channel.read(_stream(body)), self._schemas)
            self._count(opcode, channel.id, body)
            contents.channels.setdefault(channel.id, channel)
        elif opcode == Op.METADATA:
            metadata = records.Metadata.read(_stream(body))
            if metadata.name == mcap_file.METADATA:
                contents.metadata = metadata.metadata
            elif metadata.name == mcap_file.CLOCK_JUMP:
                contents.jumps.add(ClockJump.from_facts(metadata.metadata))
        elif opcode == Op.STATISTICS:
            statistics = records.Statistics.read(_stream(body))
            contents.counts = Counter(statistics.channel_message_counts)
            contents.start, contents.end = statistics.message_start_time, statistics.message_end_time
            contents.complete = True

    def _count(self, opcode: int, id: int, body: bytes) -> None:
        """Count the bytes of all descriptions of topics. Raises `McapError` if they are too many to keep."""
        self._described += len(body) - self._sizes.get((opcode, id), 0)
        self._sizes[opcode, id] = len(body)
        if self._described > _LARGEST:
            raise McapError(f"the schemas and channels have more than {_LARGEST} bytes")

    @cached_property
    def _schemas(self) -> dict[int, records.Schema]:
        return {}


def _plain(chunk: records.Chunk) -> bytes:
    """Return the content of a chunk. Raises `McapError` or an error of a decompressor if it is damaged or too large."""
    size = chunk.uncompressed_size
    if chunk.compression == "zstd":
        # The decompressor believes the frame, and not the size that is given to it.
        size = max(size, zstandard.frame_content_size(chunk.data))
    if size > _LARGEST:
        raise McapError(f"a chunk has {size} bytes; chunks of more than {_LARGEST} bytes are not read")
    if chunk.compression not in _PLAIN:
        raise McapError(f"a chunk has the unknown compression {chunk.compression!r} (known: zstd, lz4, none)")
    plain = _PLAIN[chunk.compression](chunk)
    checksum = chunk.uncompressed_crc and zlib.crc32(plain)
    if (len(plain), checksum) != (chunk.uncompressed_size, chunk.uncompressed_crc):
        raise McapError("the size or the checksum of a chunk is wrong")
    return plain


_PLAIN: Mapping[str, Callable[[records.Chunk], bytes]] = {
    "": attrgetter("data"),
    "zstd": lambda chunk: zstandard.ZstdDecompressor().decompress(chunk.data, chunk.uncompressed_size),
    "lz4": lambda chunk: lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, chunk.uncompressed_size + 1),
}


def _stream(body: bytes) -> ReadDataStream:
    return ReadDataStream(BytesIO(body))


def _channel(channel: records.Channel, schemas: Mapping[int, records.Schema]) -> Channel:
    schema = schemas.get(channel.schema_id)
    name, encoding, data = (schema.name, schema.encoding, schema.data) if schema else ("", "", b"")
    return Channel(channel.id, channel.topic, channel.message_encoding, name, encoding, data, channel.metadata)


def _records(file: IO[bytes], size: int, wanted: Collection[int], since: int = 0) -> Iterator[tuple[int, bytes]]:
    """Yield opcode and body of the complete records in the first ``size`` bytes whose opcodes are ``wanted``.

    Chunks that end before the time ``since`` are left out. Raises `McapError` for a record that is too large.
    """
    if file.tell() == 0 and file.read(len(mcap_file.MAGIC)) != mcap_file.MAGIC:
        file.seek(0)  # these are the bytes of a chunk, which have no magic
    while len(head := file.read(_RECORD.size)) == _RECORD.size:
        opcode, length = _RECORD.unpack(head)
        # The closing magic, or a record cut short by a kill.
        if head[:8] == mcap_file.MAGIC or length > size - file.tell():
            return
        if opcode not in wanted or (since and opcode == Op.CHUNK and _chunk_end(file) < since):
            file.seek(length, 1)
            continue
        if length > _LARGEST:
            raise McapError(f"a record has {length} bytes; records of more than {_LARGEST} bytes are not read")
        yield opcode, file.read(length)


def _chunk_end(file: IO[bytes]) -> int:
    """Return the time of the last message of the chunk whose content follows, without moving in the file."""
    _, end = _CHUNK_TIMES.unpack(times := file.read(_CHUNK_TIMES.size))
    file.seek(-len(times), 1)
    return int(end)


class Recording:
    """Recording with all its files: topics and datagrams, in all parts."""

    def __init__(self, path: Path) -> None:
        """Open a recording from the path of any of its files. Raises `SetupError` if the path is not an MCAP file."""
        self.files = [RecordingFile(file) for file in file_names.files_of(path)]

    @property
    def metadata(self) -> dict[str, str]:
        """Metadata that the recorder wrote into the files; empty if there is none."""
        return next((file.contents.metadata for file in self.files if file.contents.metadata), {})

    @property
    def start(self) -> int:
        """Time of the first message in nanoseconds since 1970; 0 if there is no message."""
        return min((file.contents.start for file in self.files if file.contents.start), default=0)

    @property
    def end(self) -> int:
        """Time of the last message in nanoseconds since 1970; 0 if there is no message."""
        return max((file.contents.end for file in self.files), default=0)

    @property
    def complete(self) -> bool:
        """True if every file has its summary, which the recorder writes at its end."""
        return all(file.contents.complete for file in self.files)

    @property
    def jumps(self) -> list[ClockJump]:
        """Changes of the computer's clock during the recording, in order of time."""
        return sorted(set[ClockJump]().union(*(file.contents.jumps for file in self.files)))

    def wall_at(self, time: int) -> int:
        """Return what the computer's clock showed at a steady time; both are nanoseconds since 1970."""
        return time + sum(jump.by for jump in self.jumps if jump.time <= time)

    def channels(self) -> dict[str, tuple[Channel, int]]:
        """Return, by topic, the channel and the number of its messages in all files."""
        found: dict[str, tuple[Channel, int]] = {}
        for file in self.files:
            for channel in file.contents.channels.values():
                known, count = found.get(channel.topic, (channel, 0))
                found[channel.topic] = known, count + file.contents.counts[channel.id]
        return found

    def messages(self, since: int = 0) -> Iterator[Recorded]:
        """Yield the messages of all files in order of time, from the time ``since`` (nanoseconds since 1970)."""
        halves = itertools.groupby(self.files, key=lambda file: file_names.is_datagrams(file.path))
        # The parts of a kind follow each other in time; merging reads messages only as they are needed.
        streams = [itertools.chain.from_iterable(file.messages(since) for file in list(parts)) for _, parts in halves]
        return heapq.merge(*streams, key=itemgetter(0))
