"""Signatures of datagrams: who sent a datagram, and that it is not an old one. No I/O; clocks are passed in.

The signature is a field of the envelope outside of the oneof (table key ``signing``), so a program that knows nothing
of signatures still parses the envelope. Rules of the format:

- The field is the last one of the datagram. Its value has 15 bytes: the key's id (1 byte), a timestamp (6 bytes, little
  endian) and a MAC (8 bytes).
- The MAC is keyed BLAKE2s (RFC 7693) with a digest of 8 bytes, over all bytes of the datagram before the MAC.
- The timestamp counts 10 us since 2015-01-01 UTC, as in MAVLink 2. The timestamps of a key rise with each datagram, so
  that a recorded datagram is refused.
- Only one sender signs with a key, because two senders have two clocks. Two ends therefore need two keys.
- A datagram that is overtaken by a newer one of its key is refused, too: an old command must not follow a newer one.
- If a datagram has several signature fields, the last one counts. Its MAC covers the others.

A timestamp may be years ahead of our clock: after a start without a clock, ours is the one that is wrong. Instead, a
sender that is behind continues from the latest timestamp that it verified (`SigningClock.hear`), as in MAVLink 2. Each
link has a clock of its own, so that an end sets only the clock of its own link. No end sets it more than ten years
ahead of the computer's clock.
"""

from __future__ import annotations

import ctypes
import hashlib
import hmac
import threading
import time
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, field

from roverlink.runtime.core.envelope import restore
from roverlink.runtime.core.errors import DatagramError, Reason
from roverlink.runtime.core.wire_format import DELIMITED, encoded_varint, fields

FIELD = "signature"
"""Name of the envelope's field with the signature."""
KEY_BYTES = 32
TICKS_PER_SECOND = 100_000
"""Unit of timestamps: 10 us."""
_EPOCH_NS = 1_420_070_400 * 10**9  # 2015-01-01 UTC
_TICK_NS = 10**9 // TICKS_PER_SECOND
_LARGEST = 2**48 - 1  # in the year 2104
MAC_BYTES = 8
SIGNATURE_BYTES = 15
# A sender that is further ahead has a broken clock. If it were believed, the other end would follow it for ever.
_FURTHEST_AHEAD = 10 * 365 * 24 * 3600 * TICKS_PER_SECOND
NOTABLY_AHEAD = 60 * TICKS_PER_SECOND
"""Advance of a timestamp on the computer's clock above which one of the two is wrong."""


def ticks(nanoseconds: int) -> int:
    """Convert nanoseconds since 1970 to a timestamp. A time before 2015 gives 0: that clock was never set."""
    return max(0, nanoseconds - _EPOCH_NS) // _TICK_NS


@dataclass(frozen=True, slots=True)
class Key:
    """Key that one sender signs with. Its text never contains the secret."""

    id: int
    """Number from 0 to 255, different for all keys of a receiver."""
    sender: str
    """Name of the peer or board that signs with the key; ``ros`` for the bridge."""
    secret: bytes = field(repr=False)
    """32 random bytes."""


class SigningClock(ctypes.Structure):
    """Clock of the timestamps of a program on one link. Each one is larger than all before. Thread-safe.

    It follows the computer's clock, but never goes back: it continues from the latest time that it knows. This may be
    the time of the last run, or that of the other end. The native core uses its memory, too (`rl_clock` in bridge.h).
    """

    _fields_ = (("last", ctypes.c_uint64), ("offset", ctypes.c_int64), ("shared_lock", ctypes.c_void_p))
    last: int
    """The latest timestamp that was used, or heard of the other end."""
    offset: int
    """Timestamp at the time 0 of the steady clock."""
    shared_lock: int | None
    """Address of the lock in ``lock`` if the native core uses the clock."""

    def __init__(
        self,
        earliest: int = 0,
        wall: Callable[[], int] = time.time_ns,
        steady: Callable[[], int] = time.monotonic_ns,
        made: int = 0,
    ) -> None:
        """Start after the timestamp ``earliest``. ``wall`` and ``steady`` return nanoseconds.

        ``made`` is the timestamp at which the link's keys were made: it is later now, whatever the computer's clock
        says.
        """
        last = max(earliest, ticks(wall()))
        super().__init__(last, last - steady() // _TICK_NS)
        self._wall, self._steady, self._made = wall, steady, made
        self.lock: AbstractContextManager[object] = threading.Lock()
        """Lock of the other members."""

    def next(self) -> int:
        """Return a timestamp that is larger than all earlier ones."""
        with self.lock:
            steady = self._steady() // _TICK_NS
            # In steps of the steady clock even if the computer's clock is set back: a receiver that starts again adds a
            # second to the timestamp that it had stored, and expects that we have reached it.
            self.offset = max(self.offset, ticks(self._wall()) - steady)
            self.last = min(max(self.last + 1, steady + self.offset), _LARGEST)
            return self.last

    def ahead(self, timestamp: int) -> int:
        """Return how far a timestamp is ahead of the computer's clock; 0 if the computer does not know the time."""
        present = max(ticks(self._wall()), self._made)
        return timestamp - present if present else 0

    def hear(self, timestamp: int) -> None:
        """Continue from a verified timestamp of the other end if it is later."""
        with self.lock:
            if timestamp > self.last:
                self.last = timestamp
                self.offset = max(self.offset, timestamp - self._steady() // _TICK_NS)


class Signer:
    """Signer of datagrams with one key."""

    def __init__(self, number: int, key: Key, clock: SigningClock) -> None:
        """Prepare the key; ``number`` is the field number of the envelope's signature."""
        self.number, self.key, self.clock = number, key, clock
        self._start = _field_start(number) + bytes([key.id])
        self._keyed = _keyed(key)
        self.lock: AbstractContextManager[object] = threading.Lock()
        """Lock to hold while datagrams are signed and sent, if several threads do it: the order must not change."""

    def sign(self, datagram: bytes) -> bytes:
        """Return a datagram with a signature at its end. The datagram must have no stripped or appended zeros."""
        signed = datagram + self._start + self.clock.next().to_bytes(6, "little")
        mac = self._keyed.copy()
        mac.update(signed)
        return signed + mac.digest()


class Stream(ctypes.Structure):
    """Datagrams that are signed with one key. The native core uses its memory, too (`rl_stream` in bridge.h)."""

    _fields_ = (
        ("id", ctypes.c_uint8),
        ("secret", ctypes.c_uint8 * KEY_BYTES),
        ("last", ctypes.c_uint64),
        ("plausible", ctypes.c_uint64),
        ("link", ctypes.POINTER(SigningClock)),
    )
    last: int
    """Latest timestamp that was accepted."""
    plausible: int
    """Latest timestamp that needs no look at the computer's clock, because looking takes time."""

    def __init__(self, key: Key, last: int, clock: SigningClock) -> None:
        super().__init__(key.id, (ctypes.c_uint8 * KEY_BYTES)(*key.secret), last, 0, ctypes.pointer(clock))
        self.sender, self.keyed, self.clock = key.sender, _keyed(key), clock


class Verifier:
    """Verifier of signed datagrams. To be used from one thread; `lasts` may be called from any."""

    def __init__(self, number: int, keys: Iterable[tuple[Key, int, SigningClock]]) -> None:
        """Accept the given keys, each only with timestamps larger than the one beside it.

        ``number`` is the field number of the envelope's signature. The clock beside a key is that of its link: it hears
        the timestamps that are accepted.
        """
        self.number = number
        self._start = _field_start(number)
        self._size = size_of_signature(number)
        self.streams = {key.id: Stream(key, last, clock) for key, last, clock in keys}
        """Stream of each key, by the key's id."""
        self.ahead: Counter[str] = Counter()
        """Accepted datagrams that were more than a minute ahead of the computer's clock, by their signer."""

    def lasts(self) -> Mapping[int, int]:
        """Return the latest accepted timestamp of each key, by the key's id."""
        return {id: stream.last for id, stream in self.streams.items()}

    def verify(self, datagram: bytes, senders: Collection[str], row: str = "") -> str:
        """Return which of ``senders`` has signed a datagram that is newer than all before of its key.

        Zeros at the end may have been stripped or appended. Raises `DatagramError` with the reason if the datagram is
        refused; ``row`` is the name of the payload's row for the error.
        """
        stream = self._authentic(datagram)
        if isinstance(stream, DatagramError):
            # Only now, because it takes longer than the verification.
            restored = restore(datagram)
            if restored != datagram:
                datagram, stream = restored, self._authentic(restored)
        if isinstance(stream, DatagramError):
            stream.row = row
            raise stream
        if stream.sender not in senders:
            message = (
                f"the key {datagram[-SIGNATURE_BYTES]} of {stream.sender!r} has signed a payload that is not its own"
            )
            raise DatagramError(Reason.WRONG_KEY, message, row)
        timestamp = int.from_bytes(datagram[-14:-MAC_BYTES], "little")
        if timestamp <= stream.last:
            raise _not_newer(timestamp, stream, row)
        if timestamp > stream.plausible:
            self._check_clock(stream, timestamp, row)
        if timestamp > stream.clock.last:
            stream.clock.hear(timestamp)
        stream.last = timestamp
        return stream.sender

    def _check_clock(self, stream: Stream, timestamp: int, row: str) -> None:
        """Count a timestamp that is ahead of the computer's clock. Raises `DatagramError` if it is too far ahead."""
        ahead = stream.clock.ahead(timestamp)
        if ahead > _FURTHEST_AHEAD:
            message = f"the clock of {stream.sender!r} is more than ten years ahead of this computer's; set its clock"
            raise DatagramError(Reason.AHEAD, message, row)
        if ahead > NOTABLY_AHEAD:
            self.ahead[stream.sender] += 1
        else:
            stream.plausible = timestamp - ahead + NOTABLY_AHEAD

    def _authentic(self, datagram: bytes) -> Stream | DatagramError:
        """Return the stream of the key that has signed these bytes, or the error if there is none."""
        if datagram[-self._size : -SIGNATURE_BYTES] != self._start:
            return self._without_signature(datagram)
        stream = self.streams.get(datagram[-SIGNATURE_BYTES])
        if stream is None:
            message = f"no key file has the key {datagram[-SIGNATURE_BYTES]} that a datagram is signed with"
            return DatagramError(Reason.UNKNOWN_KEY, message)
        mac = stream.keyed.copy()
        mac.update(datagram[:-MAC_BYTES])
        if hmac.compare_digest(mac.digest(), datagram[-MAC_BYTES:]):
            return stream
        message = f"the signature with the key {datagram[-SIGNATURE_BYTES]} of {stream.sender!r} is wrong"
        return DatagramError(Reason.WRONG_SIGNATURE, message)

    def _without_signature(self, datagram: bytes) -> DatagramError:
        if all(field.number != self.number for field in fields(datagram)):
            return DatagramError(Reason.UNSIGNED, "a datagram of a peer that must sign has no signature")
        message = f"the signature is not a field of {SIGNATURE_BYTES} bytes at the end of the datagram"
        return DatagramError(Reason.MALFORMED_SIGNATURE, message)


def _not_newer(timestamp: int, stream: Stream, row: str) -> DatagramError:
    if timestamp == stream.last:
        return DatagramError(Reason.REPLAYED, f"a datagram of {stream.sender!r} has come twice", row)
    late = (stream.last - timestamp) / TICKS_PER_SECOND
    message = f"a datagram of {stream.sender!r} is {late:g} s older than the newest one that is known: a recording, an "
    return DatagramError(Reason.OUTDATED, f"{message}overtaken datagram, or a sender that has lost its time", row)


def size_of_signature(number: int) -> int:
    """Return the bytes of a signature's field with a field number."""
    return len(_field_start(number)) + SIGNATURE_BYTES


def _field_start(number: int) -> bytes:
    """Return the bytes in front of a signature's value: tag and length."""
    return encoded_varint(number << 3 | DELIMITED) + bytes([SIGNATURE_BYTES])


def _keyed(key: Key) -> hashlib.blake2s:
    # Copies of one object, because setting the key up takes as long as a short datagram.
    return hashlib.blake2s(key=key.secret, digest_size=MAC_BYTES)
