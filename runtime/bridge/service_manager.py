"""Messages to the service manager that started the program, such as systemd: it is ready, alive, or about to stop.

The protocol is that of sd_notify(3): datagrams to the socket in ``NOTIFY_SOCKET``. A program that was started otherwise
has no such variable, and sends nothing.
"""

from __future__ import annotations

import os
import socket
from collections.abc import Callable
from contextlib import suppress

READY, STOPPING = "READY=1", "STOPPING=1"
_ALIVE = "WATCHDOG=1"
_A_SECOND = 1_000_000  # microseconds


def notify(state: str) -> None:
    """Send a state to the service manager, if there is one."""
    address = os.environ.get("NOTIFY_SOCKET", "")
    if not address.startswith(("/", "@")):  # another kind of address is for virtual machines
        return
    with suppress(OSError), socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC) as sender:
        sender.setblocking(False)
        sender.sendto(state.encode(), f"\0{address[1:]}" if address.startswith("@") else address)


def watchdog_s() -> float | None:
    """Return the time in seconds after which the service manager restarts a silent program; None for never."""
    microseconds, process = os.environ.get("WATCHDOG_USEC", ""), os.environ.get("WATCHDOG_PID", "")
    if not microseconds.isdecimal() or int(microseconds) == 0 or process not in ("", str(os.getpid())):
        return None
    return int(microseconds) / _A_SECOND


class Heartbeat:
    """Timed task that tells the service manager that the bridge is alive, as long as it is."""

    def __init__(self, limit_s: float, progress: Callable[[], object]) -> None:
        """Create the task. ``progress`` returns a value that changes as long as the bridge works."""
        self._interval_s, self._progress = limit_s / 4, progress
        self._before: object = None
        self.next_due = 0.0

    def run_due(self, now: float) -> None:
        """Send the message if its time has come."""
        if now < self.next_due:
            return
        self.next_due = now + self._interval_s
        before, self._before = self._before, self._progress()
        if self._before != before:
            notify(_ALIVE)
