"""Repeated look-up of a host, on a thread of its own."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

_FOUND_S = 30.0
"""Interval in seconds between two look-ups of a host that was found."""
_MISSING_S = 2.0
"""Interval in seconds between two look-ups of a host that was not found: a board may just be booting."""
_AGAIN_S = 1.0
"""Shortest interval in seconds between two look-ups, however often `HostWatch.again` is called."""
# A sleep and not a wait for an event: before Python 3.11, such a wait uses the clock that can be set (bpo-41710).
_LOOK_S = 0.1


class HostWatch:
    """Thread that looks up a host at the start, periodically, and when `again` is called.

    Every host has a thread of its own, because a look-up can block for seconds, and the look-up of a host that is
    switched off must not delay the others.
    """

    def __init__(self, look_up: Callable[[], None]) -> None:
        """Prepare the thread. ``look_up`` does one look-up; it must raise `OSError` or `UnicodeError` if that fails."""
        self._look_up = look_up
        self._wanted = True
        self._stopped = False
        self._thread = threading.Thread(target=self._run, name="host-watch", daemon=True)

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def again(self) -> None:
        """Make the thread look the host up again soon. Never blocks."""
        self._wanted = True

    def stop(self) -> None:
        """Tell the thread to end. It does not end before its present look-up, for which nobody has to wait."""
        self._stopped = True

    def _run(self) -> None:
        last, interval = float("-inf"), _AGAIN_S
        while not self._stopped:
            age = time.monotonic() - last
            if age >= interval or (self._wanted and age >= _AGAIN_S):
                self._wanted = False
                try:
                    self._look_up()
                    interval = _FOUND_S
                except (OSError, UnicodeError):
                    interval = _MISSING_S
                last = time.monotonic()
            time.sleep(_LOOK_S)
