"""Range check of ROS 2 times, which consist of int32 seconds and of nanoseconds that are added to the seconds."""

from __future__ import annotations

from roverlink.runtime.core.errors import ConversionError

NANOSECONDS = 1_000_000_000  # in a second
_SECONDS = range(-(2**31), 2**31)


def check_time(seconds: int, nanoseconds: int, field: str) -> None:
    """Raise `ConversionError` if the seconds do not fit int32, or the nanoseconds are not from 0 to 999,999,999."""
    if seconds not in _SECONDS:
        raise ConversionError(f"{seconds} seconds do not fit int32, the type of seconds in ROS 2", field)
    if not 0 <= nanoseconds < NANOSECONDS:
        raise ConversionError(f"{nanoseconds} nanoseconds are out of range (0 to {NANOSECONDS - 1})", field)
