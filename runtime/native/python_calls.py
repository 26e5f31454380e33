"""Calls of the native core back to Python, which must not raise through the core."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from roverlink.runtime.native.observer_ring import ObserverRing


class PythonCalls:
    """Guard of the calls of one loop of the core: it keeps an error, and observers get first what is older."""

    def __init__(self) -> None:
        self.ring: ObserverRing | None = None
        """Ring of the loop's observers; None without observers."""
        self.failure: BaseException | None = None
        """Error of a call, which ended the loop."""

    def guarded(self, call: Callable[..., object], *arguments: Any) -> int:
        """Return 0 after a call, or 1 if it raised an error; 1 ends the loop of the core."""
        return self.unobserved(self._in_order, call, *arguments)

    def _in_order(self, call: Callable[..., object], *arguments: Any) -> None:
        if self.ring is not None:  # what Python handles is newer
            self.ring.empty()
        call(*arguments)

    def unobserved(self, call: Callable[..., object], *arguments: Any) -> int:
        """Do the same for a call that passes nothing on to observers."""
        try:
            call(*arguments)
        except BaseException as failure:  # noqa: BLE001  # the loop raises it
            self.failure = failure
            return 1
        return 0
