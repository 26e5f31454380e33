"""google.protobuf.Duration to and from builtin_interfaces/Duration.

In protobuf, seconds and nanoseconds have one sign: -0.5 s is 0 s and -500,000,000 ns. In ROS 2 the seconds are rounded
down and the nanoseconds are added: -1 s and 500,000,000 ns.
"""

from __future__ import annotations

from google.protobuf.duration_pb2 import Duration as Payload

from roverlink.runtime.convert.well_known.seconds import NANOSECONDS, check_time
from roverlink.runtime.core.errors import ConversionError
from roverlink.runtime.interfaces import Duration


def to_ros(payload: Payload, field: str) -> Duration:
    """The duration that a payload is. Raises `ConversionError` where it is longer than 68 years, or is none."""
    return Duration(*parts(payload, field))


def parts(payload: Payload, field: str) -> tuple[int, int]:
    """`to_ros` as seconds and nanoseconds."""
    seconds, nanoseconds = payload.seconds, payload.nanos
    if not -NANOSECONDS < nanoseconds < NANOSECONDS:
        raise ConversionError(f"{nanoseconds} nanoseconds are a second or more", field)
    if seconds * nanoseconds < 0:
        raise ConversionError(f"{seconds} seconds and {nanoseconds} nanoseconds differ in their signs", field)
    if nanoseconds < 0:
        seconds, nanoseconds = seconds - 1, nanoseconds + NANOSECONDS
    check_time(seconds, nanoseconds, field)
    return seconds, nanoseconds


def from_ros(message: Duration, field: str) -> Payload:
    """The payload that a duration is. Raises `ConversionError` where it is none."""
    check_time(message.sec, message.nanosec, field)
    if message.sec < 0 < message.nanosec:
        return Payload(seconds=message.sec + 1, nanos=message.nanosec - NANOSECONDS)
    return Payload(seconds=message.sec, nanos=message.nanosec)
