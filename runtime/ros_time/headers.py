"""Headers of ROS 2 messages: a time and the name of a coordinate frame."""

from __future__ import annotations

from roverlink.runtime.core.standard_handler import nanoseconds
from roverlink.runtime.interfaces import Time
from roverlink.runtime.interfaces.std_msgs import Header


def header_of(stamp: int, frame: str) -> Header:
    """Return a message header; `stamp` is in nanoseconds since 1970, `frame` names a coordinate frame."""
    return Header(Time.since_1970(stamp), frame)


def stamp_of(header: Header) -> int:
    """Return the stamp of a header in nanoseconds since 1970."""
    return nanoseconds(header.stamp)
