"""What the generated feeds derive from: handlers whose ROS 2 message is one of the common interfaces.

A feed takes a time beside the payload: that at which the bridge took the datagram from the socket, for the header of
the message. It has no clock of its own.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import TypeVar

from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.core.handler import MISFITS, UNSTAMPED, Handler, M, P
from roverlink.runtime.interfaces import Duration, Time

__all__ = ["Counterparts", "Feed", "UNSTAMPED", "nanoseconds", "single"]

K = TypeVar("K")
V = TypeVar("V")

_TOO_LARGE = 2.0**128 - 2.0**103
"""From here on, a number is nearer to what no float of 32 bits holds than to the largest one."""


class Feed(Handler[P, M]):
    """A conversion between a payload and a standard message, with a topic of its own."""

    @staticmethod
    @abstractmethod
    def to_ros(payload: P, stamp: Time = UNSTAMPED) -> M:
        """The message that says what the payload says."""

    def pack(self, payload: P, stamp: Time = UNSTAMPED) -> bytes:
        """The serialized message of a payload: ``cdr.encode(to_ros(payload, stamp))``.

        Feeds whose varying fields have a fixed size override this with one `struct` call. It may raise what those
        raise; use `to_cdr` for an error that names the field.
        """
        return cdr.encode(self.to_ros(payload, stamp))

    def to_cdr(self, payload: P, stamp: Time = UNSTAMPED) -> bytes:
        """The serialized message of a payload; `ConversionError` names row, topic and what does not fit."""
        try:
            return self.pack(payload, stamp)
        except MISFITS:
            pass
        try:
            return cdr.encode(self.to_ros(payload, stamp))
        except MISFITS as error:
            raise self._named(error) from error

    def _pack_all(self, payloads: Sequence[P], stamp: Time) -> list[bytes]:
        return [self.pack(payload, stamp) for payload in payloads]

    def _named(self, error: Exception) -> ConversionError:
        return ConversionError(f"{self.route.name} on {self.route.topic}: {error}")


class Counterparts(dict[K, V]):
    """What each value becomes; a value without a counterpart is a `ConversionError`."""

    def __init__(self, field: str, values: Mapping[K, V]) -> None:
        super().__init__(values)
        self._field = field

    def __missing__(self, key: K) -> V:
        raise ConversionError(f"{key!r} has no counterpart", self._field)

    def back(self, field: str) -> Counterparts[V, K]:
        """The other way round; ``field`` is where its values are from."""
        return Counterparts(field, {value: key for key, value in self.items()})


def nanoseconds(time: Time | Duration) -> int:
    """A time as one number."""
    return time.sec * 1_000_000_000 + time.nanosec


def single(value: float) -> float:
    """A number for a `float` of protobuf's, which would take one that is too large for infinite."""
    if abs(value) >= _TOO_LARGE and not math.isinf(value):
        raise ConversionError(f"{value!r} does not fit a float of 32 bits")
    return value
