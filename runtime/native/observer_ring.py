"""Copies of messages and datagrams from the native core for observers, such as a recorder."""

from __future__ import annotations

import ctypes
import logging
import struct
import threading
from collections.abc import Mapping, Sequence
from itertools import groupby
from operator import itemgetter

from roverlink.runtime.core.periodic_thread import PeriodicThread
from roverlink.runtime.core.tap import Tap
from roverlink.runtime.native import bridge_layout as native
from roverlink.runtime.native.core import NativeCore

_ROOM = 4 << 20  # bytes; in a flood of small messages, several times what comes between two looks
_LOOK_S = 0.02
_RECORD = struct.Struct("=IIq")  # size, channel, time: `rl_ring` in bridge.h


class ObserverRing:
    """Ring into which one thread of the core copies what observers want, and from which Python takes it.

    A context manager, whose thread empties the ring fifty times a second.
    """

    def __init__(self, core: NativeCore, taps: Mapping[int, Sequence[Tap]], name: str) -> None:
        """Pass what is on a channel to the taps of the channel. ``name`` is the name of the thread."""
        self._core, self._taps = core, taps
        self._memory, self._out = ctypes.create_string_buffer(_ROOM), ctypes.create_string_buffer(_ROOM)
        self.struct = native.Ring(ctypes.addressof(self._memory), _ROOM)
        self._lock = threading.Lock()
        self._thread = PeriodicThread(name, _LOOK_S, self.empty, logging.getLogger("roverlink"))

    def __enter__(self) -> ObserverRing:
        self._thread.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self._thread.__exit__()
        self.empty()

    def empty(self) -> None:
        """Pass all that is in the ring to its taps, oldest first."""
        with self._lock:  # what a later call passes on is newer
            if self.struct.written == self.struct.read:
                return
            size = self._core.library.rl_take_records(ctypes.byref(self.struct), self._out)
            data, place = ctypes.string_at(self._out, size), 0
            records: list[tuple[int, int, bytes]] = []
            while place < size:
                length, channel, at = _RECORD.unpack_from(data, place)
                place += _RECORD.size
                records.append((channel, at, data[place : place + length]))
                place += -(-length // 8) * 8
            for channel, run in groupby(records, itemgetter(0)):
                _, times, messages = zip(*run)
                for tap in self._taps[channel]:
                    tap(messages, times)
