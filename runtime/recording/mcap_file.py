"""One MCAP file that is being written.

The mcap package's own writer takes 7 us of Python for a message, during which the interpreter lock is not the bridge's;
here it is 1 us, since the messages of a chunk are packed in one loop. All other records are the package's.

What is on disk is always a sequence of whole records, up to the write that a kill cut short; `flush` ends a chunk and
hands it to the disk, `finish` adds the summary that readers seek by.
"""

from __future__ import annotations

import os
import struct
import zlib
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from roverlink.runtime.core.errors import SetupError

try:
    import lz4.frame
    import zstandard
    from mcap import records
    from mcap.data_stream import ReadDataStream, RecordBuilder
    from mcap.exceptions import McapError
    from mcap.opcode import Opcode
except ImportError as error:
    raise SetupError("recordings need the mcap package; install it with `pip install 'roverlink[record]'`") from error

CHUNK_BYTES = 1024 * 1024
METADATA = "roverlink"
"""The name of the record that says which table the run had."""

MAGIC = b"\x89MCAP0\r\n"
__all__ = ["Channel", "Entry", "McapError", "McapFile", "Opcode", "ReadDataStream", "lz4", "records", "zstandard"]

_MESSAGE = struct.Struct("<BQHIQQ")
_MESSAGE_REST = _MESSAGE.size - 9  # what its length counts beside the data
_ZSTD_LEVEL = 1  # the fastest; the others gain little on chunks this small

Entry = tuple[int, int, bytes]
"""A message to write: nanoseconds since 1970, the number of its channel, its bytes."""


@dataclass(frozen=True)
class Channel:
    """One topic of a file: what its messages are, and how they are explained."""

    id: int
    topic: str
    encoding: str
    schema_name: str = ""
    schema_encoding: str = ""
    schema: bytes = b""
    metadata: Mapping[str, str] = field(default_factory=dict)


class _Record(Protocol):
    def write(self, stream: RecordBuilder) -> None: ...


def _serialized(*several: _Record) -> bytes:
    builder = RecordBuilder()
    for record in several:
        record.write(builder)
    written: bytes = builder.end()
    return written


class _Chunk:
    """Messages that are not on disk yet."""

    def __init__(self) -> None:
        self.parts: list[bytes] = []
        self.index: defaultdict[int, list[int]] = defaultdict(list)  # of each channel: time, offset, time, offset...
        self.size = 0

    def add(self, entries: Iterable[Entry]) -> None:
        parts, index, size, pack = self.parts, self.index, self.size, _MESSAGE.pack
        for time, channel, data in entries:
            length = len(data)
            parts.append(pack(Opcode.MESSAGE, _MESSAGE_REST + length, channel, 0, time, time))
            parts.append(data)
            index[channel] += time, size
            size += _MESSAGE.size + length
        self.size = size

    def span(self) -> tuple[int, int]:
        """The earliest and the latest time."""
        times = [column[::2] for column in self.index.values()]
        return min(map(min, times)), max(map(max, times))


class McapFile:
    """A file to which messages are added."""

    def __init__(self, path: Path, profile: str, compression: str, metadata: Mapping[str, str]) -> None:
        """Make the file. Raises `OSError`, with `FileExistsError` where there is one."""
        self.path = path
        self.size = 0
        """Bytes on disk, up to the end of the last whole record."""
        self.counts: Counter[int] = Counter()
        """Messages on disk, by channel."""
        self._compression = "" if compression == "none" else compression
        self._zstd = zstandard.ZstdCompressor(_ZSTD_LEVEL)
        self._file = path.open("xb", buffering=0)
        self._schemas: dict[tuple[str, bytes], records.Schema] = {}
        self._channels: list[records.Channel] = []
        self._chunk = _Chunk()
        self._chunks: list[records.ChunkIndex] = []
        self._write(MAGIC + _serialized(records.Header(profile, "roverlink")))
        record = records.Metadata(METADATA, dict(metadata))
        self._metadata = records.MetadataIndex(length=len(_serialized(record)), name=record.name, offset=self.size)
        self._write(_serialized(record))

    def add_channel(self, channel: Channel) -> None:
        """Declare a channel, before its first message. Raises `OSError`."""
        made: list[_Record] = []
        schema_id = 0
        if channel.schema_name:
            key = channel.schema_name, channel.schema
            if key not in self._schemas:
                self._schemas[key] = records.Schema(
                    id=len(self._schemas) + 1,
                    name=channel.schema_name,
                    encoding=channel.schema_encoding,
                    data=channel.schema,
                )
                made.append(self._schemas[key])
            schema_id = self._schemas[key].id
        record = records.Channel(channel.id, channel.topic, channel.encoding, dict(channel.metadata), schema_id)
        self._channels.append(record)
        self._write(_serialized(*made, record))

    def add(self, entries: Iterable[Entry]) -> None:
        """Add messages to the chunk, and write it where it has become large. Raises `OSError`."""
        self._chunk.add(entries)
        if self._chunk.size >= CHUNK_BYTES:
            self._write_chunk()

    def flush(self) -> None:
        """Write what was added, and have the disk keep it. Raises `OSError`."""
        if self._chunk.size:
            self._write_chunk()
            os.fdatasync(self._file.fileno())

    def finish(self) -> None:
        """Write what was added and the summary, and close. Raises `OSError`, and is not closed then."""
        if self._chunk.size:
            self._write_chunk()
        self._write_summary()
        self.close()

    def close(self) -> None:
        """Close the file as it is: without a summary it can be read, but not sought in."""
        self._file.close()

    def forget_chunk(self) -> int:
        """Give up the messages that are not on disk, for which there is no room; how many."""
        forgotten = sum(len(column) // 2 for column in self._chunk.index.values())
        self._chunk = _Chunk()
        return forgotten

    def _write(self, data: bytes) -> None:
        """Write whole records, or leave the file as it was."""
        rest = memoryview(data)
        try:
            while rest:
                rest = rest[self._file.write(rest) :]
        except OSError:
            self._file.truncate(self.size)
            self._file.seek(self.size)
            raise
        self.size += len(data)

    def _write_chunk(self) -> None:
        """The chunk, and the index of its messages behind it."""
        chunk, plain = self._chunk, b"".join(self._chunk.parts)
        start, end = chunk.span()
        packed = self._compressed(plain)
        crc = zlib.crc32(plain)
        record = _serialized(records.Chunk(self._compression, packed, end, start, crc, len(plain)))
        offsets: dict[int, int] = {}
        parts, place = [record], self.size + len(record)
        for channel, column in chunk.index.items():
            offsets[channel] = place
            parts.append(_message_index(channel, column))
            place += len(parts[-1])
        index = records.ChunkIndex(
            chunk_start_offset=self.size,
            chunk_length=len(record),
            message_start_time=start,
            message_end_time=end,
            message_index_offsets=offsets,
            message_index_length=place - self.size - len(record),
            compression=self._compression,
            compressed_size=len(packed),
            uncompressed_size=len(plain),
        )
        self._write(b"".join(parts))
        self._chunks.append(index)
        self.counts.update({channel: len(column) // 2 for channel, column in chunk.index.items()})
        self._chunk = _Chunk()

    def _compressed(self, data: bytes) -> bytes:
        if self._compression == "zstd":
            return self._zstd.compress(data)
        if self._compression == "lz4":
            packed: bytes = lz4.frame.compress(data)
            return packed
        return data

    def _write_summary(self) -> None:
        data_end = _serialized(records.DataEnd(0))
        start = self.size + len(data_end)
        groups: list[tuple[Opcode, list[_Record]]] = [
            (Opcode.SCHEMA, list(self._schemas.values())),
            (Opcode.CHANNEL, list(self._channels)),
            (Opcode.STATISTICS, [self._statistics()]),
            (Opcode.CHUNK_INDEX, list(self._chunks)),
            (Opcode.METADATA_INDEX, [self._metadata]),
        ]
        summary, offsets = b"", []
        for opcode, group in groups:
            if group:
                written = _serialized(*group)
                offsets.append(records.SummaryOffset(opcode, start + len(summary), len(written)))
                summary += written
        offsets_start = start + len(summary)
        summary += _serialized(*offsets)
        # The checksum covers the footer up to itself: opcode, length, and the two places.
        crc = zlib.crc32(summary + struct.pack("<BQQQ", Opcode.FOOTER, 20, start, offsets_start))
        self._write(data_end + summary + _serialized(records.Footer(start, offsets_start, crc)) + MAGIC)

    def _statistics(self) -> records.Statistics:
        return records.Statistics(
            attachment_count=0,
            channel_count=len(self._channels),
            channel_message_counts=dict(self.counts),
            chunk_count=len(self._chunks),
            message_count=self.counts.total(),
            message_end_time=max((chunk.message_end_time for chunk in self._chunks), default=0),
            message_start_time=min((chunk.message_start_time for chunk in self._chunks), default=0),
            metadata_count=1,
            schema_count=len(self._schemas),
        )


def _message_index(channel: int, column: list[int]) -> bytes:
    """Where a chunk has the messages of a channel."""
    size = 8 * len(column)
    return struct.pack(f"<BQHI{len(column)}Q", Opcode.MESSAGE_INDEX, 6 + size, channel, size, *column)
