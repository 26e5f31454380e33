"""Import of PyAV, which is optional, as `av`, with an explanation of how to install it."""

from __future__ import annotations

from roverlink.runtime.core.errors import SetupError

try:
    import av
except ImportError as error:
    raise SetupError(f"video needs PyAV ({error}); install it with `pip install 'av>=12'`") from error

__all__ = ["av"]

# FFmpeg prints what it finds in damaged streams on standard error; the receiver counts it instead.
av.logging.set_level(av.logging.PANIC)
