"""google.protobuf.Timestamp to and from builtin_interfaces/Time; in both, nanoseconds count forward."""

from __future__ import annotations

from google.protobuf.timestamp_pb2 import Timestamp

from roverlink.runtime.convert.well_known.seconds import check_time
from roverlink.runtime.interfaces import Time


def to_ros(payload: Timestamp, field: str) -> Time:
    """Convert a timestamp. Raises `ConversionError` if it is before 1901, after 2038 (int32 seconds) or invalid."""
    return Time(*parts(payload, field))


def parts(payload: Timestamp, field: str) -> tuple[int, int]:
    """Convert as `to_ros`, to a pair of seconds and nanoseconds."""
    check_time(payload.seconds, payload.nanos, field)
    return payload.seconds, payload.nanos


def from_ros(message: Time, field: str) -> Timestamp:
    """Convert a time back. Raises `ConversionError` if its nanoseconds are a second or more."""
    check_time(message.sec, message.nanosec, field)
    return Timestamp(seconds=message.sec, nanos=message.nanosec)
