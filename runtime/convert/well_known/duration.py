"""Conversion of google.protobuf.Duration to builtin_interfaces/Duration and back.

In protobuf, seconds and nanoseconds have the same sign (duration.proto): -0.5 s is 0 s and -500,000,000 ns. In ROS 2
nanoseconds are never negative: -0.5 s is -1 s and 500,000,000 ns.
"""

from __future__ import annotations

from google.protobuf.duration_pb2 import Duration as Payload

from roverlink.runtime.convert.well_known.seconds import NANOSECONDS, check_time
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.interfaces import Duration


def to_ros(payload: Payload, field: str) -> Duration:
    """Convert a protobuf duration to a ROS 2 duration.

    Raises `ConversionError` if it is longer than 68 years (the range of int32 seconds), or is not a valid duration.
    """
    return Duration(*parts(payload, field))


def parts(payload: Payload, field: str) -> tuple[int, int]:
    """Convert a protobuf duration to ROS 2's seconds and nanoseconds. Raises `ConversionError` as `to_ros` does."""
    seconds, nanoseconds = payload.seconds, payload.nanos
    if not -NANOSECONDS < nanoseconds < NANOSECONDS:
        raise ConversionError(f"{nanoseconds} nanoseconds are a second or more; protobuf allows less", field)
    if seconds * nanoseconds < 0:
        raise ConversionError(
            f"{seconds} s and {nanoseconds} ns have different signs, which protobuf does not allow",
            field,
        )
    # Borrow a second, since ROS 2 stores nanoseconds as uint32.
    if nanoseconds < 0:
        seconds, nanoseconds = seconds - 1, nanoseconds + NANOSECONDS
    check_time(seconds, nanoseconds, field)
    return seconds, nanoseconds


def from_ros(message: Duration, field: str) -> Payload:
    """Convert a ROS 2 duration to protobuf. Raises `ConversionError` if the nanoseconds are a second or more."""
    check_time(message.sec, message.nanosec, field)
    if message.sec < 0 < message.nanosec:
        return Payload(seconds=message.sec + 1, nanos=message.nanosec - NANOSECONDS)
    return Payload(seconds=message.sec, nanos=message.nanosec)
