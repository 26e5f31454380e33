"""What ROS 2's times hold: seconds in 32 bits, and the nanoseconds that are to be added to them."""

from __future__ import annotations

from roverlink.runtime.core.errors import ConversionError

NANOSECONDS = 1_000_000_000  # in a second
_SECONDS = range(-(2**31), 2**31)


def check_time(seconds: int, nanoseconds: int, field: str) -> None:
    """Raise `ConversionError` for what builtin_interfaces cannot hold, or what is no part of a second."""
    if seconds not in _SECONDS:
        raise ConversionError(f"{seconds} seconds do not fit int32, which is what ROS 2's times have", field)
    if not 0 <= nanoseconds < NANOSECONDS:
        raise ConversionError(f"{nanoseconds} nanoseconds are not from 0 to {NANOSECONDS - 1}", field)
