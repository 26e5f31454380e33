"""google.protobuf.Timestamp to and from builtin_interfaces/Time; both count nanoseconds upwards."""

from __future__ import annotations

from google.protobuf.timestamp_pb2 import Timestamp

from roverlink.runtime.convert.well_known.seconds import check_time
from roverlink.runtime.interfaces import Time


def to_ros(payload: Timestamp, field: str) -> Time:
    """The time that a timestamp is. Raises `ConversionError` where it is before 1901 or after 2038, or is none."""
    return Time(*parts(payload, field))


def parts(payload: Timestamp, field: str) -> tuple[int, int]:
    """`to_ros` as seconds and nanoseconds."""
    check_time(payload.seconds, payload.nanos, field)
    return payload.seconds, payload.nanos


def from_ros(message: Time, field: str) -> Timestamp:
    """The timestamp that a time is. Raises `ConversionError` where it is none."""
    check_time(message.sec, message.nanosec, field)
    return Timestamp(seconds=message.sec, nanos=message.nanosec)
