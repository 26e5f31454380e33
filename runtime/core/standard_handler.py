"""Base class of generated handlers that convert payloads to standard ROS 2 messages, such as sensor_msgs/Imu.

Handlers of extra topics use it, and handlers of rows whose message is a standard one. The conversion also takes the
receive time of the payload, for the header of the message. The handler has no clock of its own.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Mapping
from typing import TypeVar

from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.core.handler import MISFITS, UNSTAMPED, Handler, M, P
from roverlink.runtime.interfaces import Duration, Time

__all__ = ["Counterparts", "StandardHandler", "UNSTAMPED", "nanoseconds", "single"]

K = TypeVar("K")
V = TypeVar("V")

_TOO_LARGE = 2.0**128 - 2.0**103
"""Smallest number that rounds to infinity in float32: halfway between the largest float32 and 2**128."""


class StandardHandler(Handler[P, M]):
    """Converter between a payload and a standard ROS 2 message."""

    @staticmethod
    @abstractmethod
    def to_ros(payload: P, stamp: Time = UNSTAMPED) -> M:
        """Convert a payload to the standard message; ``stamp`` is the time for its header."""

    def to_cdr(self, payload: P, stamp: Time = UNSTAMPED) -> bytes:
        """Convert a payload to its serialized ROS 2 message (CDR).

        Raises `ConversionError` that names row, topic and field.
        """
        try:
            return cdr.encode(self.to_ros(payload, stamp))
        except MISFITS as error:
            raise self._named(error) from error

    def _named(self, error: Exception) -> ConversionError:
        return ConversionError(f"{self.route.name} on {self.route.topic}: {error}")


class Counterparts(dict[K, V]):
    """Map from values of a proto field to values of a ROS 2 field, as the table lists them, or in the other direction.

    A look-up of a value that the map does not contain raises `ConversionError`.
    """

    def __init__(self, field: str, values: Mapping[K, V]) -> None:
        super().__init__(values)
        self._field = field

    def __missing__(self, key: K) -> V:
        raise ConversionError(f"{key!r} is not among the values that the table lists for it", self._field)

    def back(self, field: str) -> Counterparts[V, K]:
        """Return the map for the opposite direction; errors of the returned map name ``field``."""
        return Counterparts(field, {value: key for key, value in self.items()})


def nanoseconds(time: Time | Duration) -> int:
    """Return a ROS 2 time or duration as a number of nanoseconds: 1 s and 500 ns -> 1,000,000,500."""
    return time.sec * 1_000_000_000 + time.nanosec


def single(value: float) -> float:
    """Return a number unchanged if it fits protobuf's 32-bit `float`. Raises `ConversionError` if it is too large.

    Protobuf itself would store a number that is too large as infinity, without an error.
    """
    if abs(value) >= _TOO_LARGE and not math.isinf(value):
        raise ConversionError(f"{value!r} is too large for float32")
    return value
