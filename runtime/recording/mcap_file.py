"""Writer of one MCAP file (mcap.dev/spec), the file format of recordings.

The mcap package's writer needs 7 us of Python for each message, and the bridge waits for the interpreter lock
meanwhile. This writer needs 1 us, because it packs the messages of a chunk in one loop. Those of the native core come
in blocks, which the core packs itself. The mcap package writes all other records.

A file on disk consists of complete records; only if the program is killed during a write, the last record may be
incomplete. `flush` ends a chunk and waits until the disk has stored it. `finish` writes the summary, which readers need
to jump to a time. `finish_anyway` ends a file on a full disk.

Each message has two times. Its log time, by which readers sort, counts on steadily even if the clock of the computer is
set during the run. Its publish time is what that clock showed.
"""

from __future__ import annotations

import errno
import os
import struct
import sys
import zlib
from array import array
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol, TypeVar

import lz4.frame
import zstandard
from mcap import records
from mcap.data_stream import ReadDataStream, RecordBuilder
from mcap.exceptions import McapError
from mcap.opcode import Opcode

from roverlink.runtime.core.tap import Block

# A file, from its beginning to its end (MCAP specification, File Structure):
#
#     magic, Header, Metadata
#     Schema and Channel records, before the first message that needs them
#     Chunk, and the Message Index of each of its channels; again and again
#     Data End
#     summary: Schema, Channel, Statistics, Chunk Index, Metadata Index; then Summary Offset
#     Footer, magic
#
# Everything up to Data End is written as it comes, so a file that ends anywhere before it can still be read to the end
# of its last whole record.
CHUNK_BYTES = 1024 * 1024
METADATA = "roverlink"
"""Name of the MCAP metadata record with facts about the run, such as the fingerprint of its table."""
CLOCK_JUMP = "roverlink.clock_jump"
"""Name of the MCAP metadata records that each say when the computer's clock was set, and by how much."""

MAGIC = b"\x89MCAP0\r\n"
__all__ = ["Channel", "Entry", "McapError", "McapFile", "Opcode", "ReadDataStream", "lz4", "records", "zstandard"]

# The Message record of the MCAP specification: opcode, length, channel id, sequence, log time, publish time.
_MESSAGE = struct.Struct("<BQHIQQ")
_MESSAGE_REST = _MESSAGE.size - 9  # the record's length without opcode, length field and data
_LATEST_TIME = 2**64 - 1  # that MCAP has
_ZSTD_LEVEL = 1  # the fastest; higher levels gain little on chunks of this size

_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
# A file on a full disk gives up at most this share of its bytes for a summary; a summary can be made again, messages
# cannot.
_SUMMARY_SHARE = 0.25

Entry = tuple[int, int, int, bytes]
"""Message to write: log time and publish time (both in nanoseconds since 1970), channel number, bytes."""


@dataclass(frozen=True)
class Channel:
    """Channel of an MCAP file: a topic, with the encoding and the schema of its messages."""

    id: int
    topic: str
    encoding: str
    schema_name: str = ""
    schema_encoding: str = ""
    schema: bytes = b""
    metadata: Mapping[str, str] = field(default_factory=dict)


class _Record(Protocol):
    def write(self, stream: RecordBuilder) -> None: ...


_Kind = TypeVar("_Kind", bound=_Record)


@dataclass(frozen=True)
class _Written:
    """Record on disk that the summary lists: a schema, a channel, metadata, or a chunk with its message indexes."""

    start: int
    """Place in the file."""
    record: _Record
    """Record of the summary: the schema or channel itself, or the index of the metadata or chunk."""
    counts: Mapping[int, int] = field(default_factory=dict)
    """Messages of the chunk, by channel."""


def _serialized(*several: _Record) -> bytes:
    builder = RecordBuilder()
    for record in several:
        record.write(builder)
    written: bytes = builder.end()
    return written


class _Chunk:
    """Messages of an MCAP chunk that are not on disk yet."""

    def __init__(self) -> None:
        self.parts: list[bytes | bytearray] = []
        # by channel: time, offset, time, offset...
        self.index: defaultdict[int, array[int]] = defaultdict(lambda: array("Q"))
        self.size = 0
        self.earliest, self.latest = _LATEST_TIME, 0
        """Times of the messages, in nanoseconds since 1970."""

    def add(self, entries: Iterable[Entry]) -> None:
        parts, index, size, pack = self.parts, self.index, self.size, _MESSAGE.pack
        earliest, latest = self.earliest, self.latest
        for time, wall, channel, data in entries:
            length = len(data)
            parts.append(pack(Opcode.MESSAGE, _MESSAGE_REST + length, channel, 0, time, wall))
            parts.append(data)
            index[channel].extend((time, size))
            size += _MESSAGE.size + length
            earliest = time if time < earliest else earliest
            latest = time if time > latest else latest
        self.size, self.earliest, self.latest = size, earliest, latest

    def add_block(self, block: Block, log_time: int, publish_time: int) -> None:
        records, columns = block.records(log_time, publish_time, self.size)
        self.parts.append(records)
        for channel, column in columns:
            self.index[channel].extend(column)
            self.earliest, self.latest = min(self.earliest, column[0]), max(self.latest, column[-2])
        self.size += len(records)


class McapFile:
    """MCAP file that is being written."""

    def __init__(self, path: Path, profile: str, compression: str, metadata: Mapping[str, str]) -> None:
        """Create the file. Raises `FileExistsError` if it exists, and `OSError` if it cannot be written.

        An error leaves no file behind.
        """
        self.path = path
        self.size = 0
        """Bytes on disk, up to the end of the last complete record."""
        self.counts: Counter[int] = Counter()
        """Messages on disk, by channel."""
        self._compression = "" if compression == "none" else compression
        self._zstd = zstandard.ZstdCompressor(_ZSTD_LEVEL)
        # Exclusive creation never overwrites a recording. Unbuffered, because chunks are large already.
        self._file = path.open("xb", buffering=0)
        self._schemas: dict[tuple[str, bytes], records.Schema] = {}
        self._written: list[_Written] = []
        self._chunk = _Chunk()
        self._room = 0  # bytes for which the disk had room when a write failed
        try:
            self._write(MAGIC + _serialized(records.Header(profile, "roverlink")))
            self.add_metadata(METADATA, metadata)
            # A disk that has no room for an end now has none later, when `finish_anyway` needs it.
            start = self.size
            self._write(self._ending(summary=False))
            self._truncate(start)
        except OSError:
            self.close()
            path.unlink()
            raise

    def add_metadata(self, name: str, facts: Mapping[str, str]) -> None:
        """Write a metadata record. Raises `OSError`."""
        record = _serialized(records.Metadata(name, dict(facts)))
        index = records.MetadataIndex(length=len(record), name=name, offset=self.size)
        self._write(record, _Written(self.size, index))

    def add_channel(self, channel: Channel) -> None:
        """Write the records that declare a channel; call it before the channel's first message. Raises `OSError`."""
        # 0 means that the channel has no schema; ids of schemas begin with 1 (MCAP specification, Channel and Schema).
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
                self._write(_serialized(self._schemas[key]), _Written(self.size, self._schemas[key]))
            schema_id = self._schemas[key].id
        record = records.Channel(channel.id, channel.topic, channel.encoding, dict(channel.metadata), schema_id)
        self._write(_serialized(record), _Written(self.size, record))

    def add(self, entries: Iterable[Entry]) -> None:
        """Add messages to the chunk, and write the chunk if it is large enough. Raises `OSError`."""
        self._chunk.add(entries)
        self._write_large_chunk()

    def add_block(self, block: Block, log_time: int, publish_time: int) -> None:
        """Add messages from the native core; the times are those of `Block.records`. Raises `OSError`."""
        self._chunk.add_block(block, log_time, publish_time)
        self._write_large_chunk()

    def _write_large_chunk(self) -> None:
        if self._chunk.size >= CHUNK_BYTES:
            self._write_chunk()

    def flush(self) -> None:
        """Write the chunk and wait until the disk has stored it. Raises `OSError`."""
        if self._chunk.size:
            self._write_chunk()
            # fdatasync and not fsync: the file's times need not reach the disk, its size and data do (fsync(2)).
            os.fdatasync(self._file.fileno())

    def finish(self) -> None:
        """Write the chunk and the summary, and close the file. If this raises `OSError`, the file stays open."""
        if self._chunk.size:
            self._write_chunk()
        self._write(self._ending(summary=True))
        self.close()

    def finish_anyway(self) -> int:
        """End and close the file after an error, and return the number of messages that are lost by that.

        The messages that are not on disk yet are lost. If the disk has no room for the summary, the last chunks make
        room for it. If that would cost too many messages, the file ends without a summary; readers then read it from
        the beginning. Only if no end can be written at all, the file has none.
        """
        lost = sum(len(column) // 2 for column in self._chunk.index.values())
        self._chunk = _Chunk()
        before = self.counts.total()
        for summary, least in ((True, self.size * (1 - _SUMMARY_SHARE)), (False, 0)):
            if self._ended_within(summary, least):
                break
        self.close()
        return lost + before - self.counts.total()

    def _ended_within(self, summary: bool, least: float) -> bool:
        """Write the end, and cut off the last records as long as the disk is full; return false if that is no help.

        At least ``least`` bytes of the file are kept.
        """
        while True:
            ending = self._ending(summary)
            try:
                self._write(ending)
            except OSError as error:
                # Another program may use the room that cutting gives, so one cut may be too little.
                target = self.size - (len(ending) - self._room)
                if error.errno not in _FULL or target < least or not self._cut(target):
                    return False
            else:
                return True

    def _cut(self, target: int) -> bool:
        """Cut off the last records so that at most ``target`` bytes remain. Return false if there are none to cut.

        The metadata about the run, the first record, always remains.
        """
        removed = False
        while self.size > target and len(self._written) > 1:
            last = self._written.pop()
            self.size = last.start
            self.counts.subtract(last.counts)
            removed = True
        self._truncate(self.size)
        return removed

    def _truncate(self, size: int) -> None:
        self.size = size
        self._file.truncate(size)
        self._file.seek(size)

    def close(self) -> None:
        """Close the file without writing an end."""
        self._file.close()

    def _write(self, data: bytes, written: _Written | None = None) -> None:
        """Write complete records; the summary will list the record ``written``.

        If this fails, cut off the incomplete record and raise `OSError`.
        """
        rest = memoryview(data)
        try:
            while rest:
                rest = rest[self._file.write(rest) :]
        except OSError:
            self._room = len(data) - len(rest)
            # A record that was written in part would make the rest of the file unreadable.
            self._truncate(self.size)
            raise
        self.size += len(data)
        if written is not None:
            self._written.append(written)
            self.counts.update(written.counts)

    def _write_chunk(self) -> None:
        """Write the Chunk record and, after it, the Message Index records of its channels."""
        chunk, plain = self._chunk, b"".join(self._chunk.parts)
        packed = self._compressed(plain)
        # The checksum covers the uncompressed records, so it also finds faults of the compression.
        crc = zlib.crc32(plain)
        record = _serialized(records.Chunk(self._compression, packed, chunk.latest, chunk.earliest, crc, len(plain)))
        offsets: dict[int, int] = {}
        parts, place = [record], self.size + len(record)
        for channel, column in chunk.index.items():
            offsets[channel] = place
            parts.append(_message_index(channel, column))
            place += len(parts[-1])
        index = records.ChunkIndex(
            chunk_start_offset=self.size,
            chunk_length=len(record),
            message_start_time=chunk.earliest,
            message_end_time=chunk.latest,
            message_index_offsets=offsets,
            message_index_length=place - self.size - len(record),
            compression=self._compression,
            compressed_size=len(packed),
            uncompressed_size=len(plain),
        )
        counts = {channel: len(column) // 2 for channel, column in chunk.index.items()}
        self._write(b"".join(parts), _Written(self.size, index, counts))
        self._chunk = _Chunk()

    def _compressed(self, data: bytes) -> bytes:
        if self._compression == "zstd":
            return self._zstd.compress(data)
        if self._compression == "lz4":
            packed: bytes = lz4.frame.compress(data)
            return packed
        return data

    def _ending(self, summary: bool) -> bytes:
        """Return the records after the last chunk: Data End, the summary unless it is left out, Footer and magic."""
        # 0: there is no checksum of the whole data section. Each chunk has its own, and a checksum of everything would
        # need a pass over a file of gigabytes.
        data_end = _serialized(records.DataEnd(0))
        if not summary:
            return data_end + _serialized(records.Footer(0, 0, 0)) + MAGIC
        start = self.size + len(data_end)
        # The summary groups its records by opcode, and a Summary Offset record leads to each group (MCAP specification,
        # Summary Section). A reader gets topics and counts from the end of the file, without its data.
        groups: list[tuple[Opcode, Sequence[_Record]]] = [
            (Opcode.SCHEMA, self._listed(records.Schema)),
            (Opcode.CHANNEL, self._listed(records.Channel)),
            (Opcode.STATISTICS, [self._statistics()]),
            (Opcode.CHUNK_INDEX, self._listed(records.ChunkIndex)),
            (Opcode.METADATA_INDEX, self._listed(records.MetadataIndex)),
        ]
        grouped, offsets = b"", []
        for opcode, group in groups:
            if group:
                written = _serialized(*group)
                offsets.append(records.SummaryOffset(opcode, start + len(grouped), len(written)))
                grouped += written
        offsets_start = start + len(grouped)
        grouped += _serialized(*offsets)
        # The checksum covers the summary and the footer's first fields: opcode, length and two offsets.
        crc = zlib.crc32(grouped + struct.pack("<BQQQ", Opcode.FOOTER, 20, start, offsets_start))
        return data_end + grouped + _serialized(records.Footer(start, offsets_start, crc)) + MAGIC

    def _listed(self, kind: type[_Kind]) -> list[_Kind]:
        return [written.record for written in self._written if isinstance(written.record, kind)]

    def _statistics(self) -> records.Statistics:
        chunks = self._listed(records.ChunkIndex)
        return records.Statistics(
            attachment_count=0,
            channel_count=len(self._listed(records.Channel)),
            channel_message_counts=dict(+self.counts),
            chunk_count=len(chunks),
            message_count=self.counts.total(),
            message_end_time=max((chunk.message_end_time for chunk in chunks), default=0),
            message_start_time=min((chunk.message_start_time for chunk in chunks), default=0),
            metadata_count=len(self._listed(records.MetadataIndex)),
            schema_count=len(self._listed(records.Schema)),
        )


def _message_index(channel: int, column: array[int]) -> bytes:
    """Return the Message Index record of one channel in a chunk; ``column`` holds time and offset of each message."""
    # An array of pairs (time, offset), 16 bytes each. An offset counts from the start of the uncompressed chunk.
    if sys.byteorder == "big":
        column = column[:]
        column.byteswap()
    pairs = column.tobytes()
    return struct.pack("<BQHI", Opcode.MESSAGE_INDEX, 6 + len(pairs), channel, len(pairs)) + pairs
