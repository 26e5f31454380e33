"""Conversion of google.protobuf.Timestamp to builtin_interfaces/Time and back.

In both types, nanoseconds are never negative.
"""

from __future__ import annotations

from google.protobuf.timestamp_pb2 import Timestamp

from roverlink.runtime.convert.well_known.seconds import check_time
from roverlink.runtime.interfaces import Time


def to_ros(payload: Timestamp, field: str) -> Time:
    """Convert a protobuf timestamp to a ROS 2 time.

    Raises `ConversionError` if it is before 1901 or after 2038 (the range of int32 seconds), or is not a valid
    timestamp.
    """
    return Time(*parts(payload, field))


def parts(payload: Timestamp, field: str) -> tuple[int, int]:
    """Convert a protobuf timestamp to ROS 2's seconds and nanoseconds. Raises `ConversionError` as `to_ros` does."""
    check_time(payload.seconds, payload.nanos, field)
    return payload.seconds, payload.nanos


def from_ros(message: Time, field: str) -> Timestamp:
    """Convert a ROS 2 time to protobuf. Raises `ConversionError` if the nanoseconds are a second or more."""
    check_time(message.sec, message.nanosec, field)
    return Timestamp(seconds=message.sec, nanos=message.nanosec)
