"""Warning that the network has changed since the bridge joined ROS 2, which then may not reach other computers."""

from __future__ import annotations

from collections.abc import Callable

from roverlink.runtime.bridge.account import Account, ThrottledWarnings

_LOOK_S = 2.0


class NetworkWatch:
    """Timed task that looks every two seconds for changes of this computer's addresses."""

    def __init__(self, changes: Callable[[], str], account: Account, warnings: ThrottledWarnings) -> None:
        """Create the task; ``changes`` is `Middleware.address_changes`."""
        self._changes, self._account, self._warnings = changes, account, warnings
        self._known = ""
        self.next_due = 0.0

    def run_due(self, now: float) -> None:
        """Look for changes if two seconds have passed; log and store a new text about them."""
        if now < self.next_due:
            return
        self.next_due = now + _LOOK_S
        text = self._changes()
        if text == self._known:
            return
        self._known = text
        if text:
            self._warnings.warn("network", text)
        # One assignment, because the monitor reads on another thread.
        self._account.standing = self._account.standing | {"network": text}
