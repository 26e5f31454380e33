"""Range of ROS 2 times: int32 seconds, and nanoseconds that are added to them."""

from __future__ import annotations

from roverlink.runtime.core.errors import ConversionError

NANOSECONDS = 1_000_000_000  # in a second
_SECONDS = range(-(2**31), 2**31)


def check_time(seconds: int, nanoseconds: int, field: str) -> None:
    """Raise `ConversionError` if builtin_interfaces cannot hold the time, or the nanoseconds are a second or more."""
    if seconds not in _SECONDS:
        raise ConversionError(f"{seconds} seconds do not fit int32, the type of seconds in ROS 2", field)
    if not 0 <= nanoseconds < NANOSECONDS:
        raise ConversionError(f"{nanoseconds} nanoseconds are out of range (0 to {NANOSECONDS - 1})", field)
