"""Copies of messages and datagrams from the native core for observers, such as a recorder."""

from __future__ import annotations

import ctypes
import logging
import struct
import threading
from array import array
from collections import defaultdict
from collections.abc import Mapping, Sequence

from roverlink.runtime.core.periodic_thread import PeriodicThread
from roverlink.runtime.core.tap import BlockFile, FileTap, NewestTap, Sources, Tap
from roverlink.runtime.native import bridge_layout as native
from roverlink.runtime.native.core import NativeCore

_ROOM = 4 << 20  # bytes; in a flood of small messages, several times what comes between two looks
_LOOK_S = 0.05
_RECORD = struct.Struct("=IIq")  # size, channel, time: `rl_ring` in bridge.h


class ObserverRing:
    """Ring into which one thread of the core copies what observers want, and from which Python takes it.

    A context manager. If a tap waits for messages, a thread empties the ring twenty times a second; files and taps of
    the newest message let it be emptied when they need the messages (see `Sources`). If the ring is full, the core
    hands the next message over, which empties it, too (`PythonCalls`).
    """

    def __init__(self, core: NativeCore, taps: Mapping[int, Sequence[Tap]], name: str) -> None:
        """Pass what is on a channel to the taps of the channel. ``name`` is the name of the thread.

        What goes to files stays in the form of the core, without an object of Python for each message.
        """
        self._core = core
        self._files: dict[BlockFile, ctypes.Array[ctypes.c_uint16]] = {}
        self._taps: dict[int, list[Tap]] = {}
        self._of_newest: dict[int, list[Tap]] = {}
        self._readers: set[Sources] = set()
        self._channels = max(taps) + 1
        for channel, listeners in taps.items():
            for tap in listeners:
                if isinstance(tap, FileTap):
                    channels = self._files.setdefault(tap.file, (ctypes.c_uint16 * self._channels)())
                    channels[channel] = tap.channel
                    self._readers.add(tap.file.sources)
                elif isinstance(tap, NewestTap):
                    self._of_newest.setdefault(channel, []).append(tap)
                    self._readers.add(tap.sources)
                else:
                    self._taps.setdefault(channel, []).append(tap)
        self._memory, self._out = ctypes.create_string_buffer(_ROOM), ctypes.create_string_buffer(_ROOM)
        self.struct = native.Ring(ctypes.addressof(self._memory), _ROOM)
        self._lock = threading.Lock()
        self._thread = PeriodicThread(name, _LOOK_S, self.empty, logging.getLogger("roverlink"))

    def __enter__(self) -> ObserverRing:
        for reader in self._readers:
            reader.add(self.empty)
        if self._taps:
            self._thread.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self._thread.__exit__()
        for reader in self._readers:
            reader.remove(self.empty)
        self.empty()

    def empty(self) -> None:
        """Pass all that is in the ring to its taps, oldest first."""
        with self._lock:  # what a later call passes on is newer
            if self.struct.written == self.struct.read:
                return
            size = self._core.library.rl_take_records(ctypes.byref(self.struct), self._out)
            records = ctypes.string_at(self._out, size)
            for file, channels in self._files.items():
                block = RingBlock(self._core.library, records, channels)
                if block.count:
                    file.put(block)
            if self._of_newest:
                self._pass_newest_on(records)
            if self._taps:
                self._pass_on(records)

    def _pass_newest_on(self, records: bytes) -> None:
        places = (ctypes.c_uint64 * self._channels)()
        self._core.library.rl_newest_records(records, len(records), places)
        for channel, taps in self._of_newest.items():
            if place := places[channel]:
                length, _, at = _RECORD.unpack_from(records, place - 1)
                start = place - 1 + _RECORD.size
                for tap in taps:
                    tap([records[start : start + length]], [at])

    def _pass_on(self, records: bytes) -> None:
        found: defaultdict[int, tuple[list[bytes], list[int]]] = defaultdict(lambda: ([], []))
        place = 0
        while place < len(records):
            length, channel, at = _RECORD.unpack_from(records, place)
            place += _RECORD.size
            if (channel := channel & ~native.RAW) in self._taps:
                messages, times = found[channel]
                messages.append(records[place : place + length])
                times.append(at)
            place += -(-length // 8) * 8
        for channel, (messages, times) in found.items():
            for tap in self._taps[channel]:
                tap(messages, times)


class RingBlock:
    """Block with the records that a file gets (see `Block`)."""

    def __init__(self, library: ctypes.CDLL, records: bytes, channels: ctypes.Array[ctypes.c_uint16]) -> None:
        self._library = library
        self._recording = native.Recording(records, len(records), channels)
        self._runs = (native.Run * (2 * len(channels)))()
        self._n_runs = library.rl_count_records(ctypes.byref(self._recording), self._runs)
        self.count = sum(run.count for run in self._runs[: self._n_runs])

    def records(
        self, log_time: int, publish_time: int, offset: int
    ) -> tuple[bytearray, Sequence[tuple[int, array[int]]]]:
        """Return the records of a file, as `Block` says."""
        self._recording.log_time, self._recording.publish_time = log_time, publish_time
        out, index = bytearray(2 * self._recording.size), array("Q", bytes(16 * self.count))
        size = self._library.rl_record(
            ctypes.byref(self._recording),
            self._runs,
            self._n_runs,
            offset,
            ctypes.byref(ctypes.c_char.from_buffer(out)),
            index.buffer_info()[0],
        )
        columns, first = [], 0
        for run in self._runs[: self._n_runs]:
            columns.append((run.channel, index[2 * first : 2 * (first + run.count)]))
            first += run.count
        return out[:size], columns
