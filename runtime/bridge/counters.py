"""Counting of received, dropped and unsent datagrams, with a throttled warning for each kind of loss."""

from __future__ import annotations

import logging
import socket
import threading
import time

from roverlink.numerals import counted
from roverlink.runtime.bridge.account import WARNING_INTERVAL_S, Account, ThrottledWarnings
from roverlink.runtime.core.errors import DatagramError, Reason
from roverlink.runtime.net import udp
from roverlink.runtime.net.destination import Destination, is_told_by_event


class Counters:
    """Counters of a bridge, its warnings, and the kernel's drop counter. Used by all threads of the bridge."""

    def __init__(self, sock: socket.socket, logger: logging.Logger) -> None:
        self.account = Account()
        self.warnings = ThrottledWarnings(logger)
        self._socket = sock
        self._next_look = 0.0
        self._lock = threading.Lock()

    def count_received(self, count: int) -> None:
        """Count datagrams read from the socket; every two seconds also read the kernel's drop counter."""
        self.account.received += count
        if time.monotonic() >= self._next_look:
            self._next_look = time.monotonic() + WARNING_INTERVAL_S
            self.read_kernel_drops()

    def count_dropped(self, error: DatagramError) -> None:
        """Count a datagram that is not bridged, and log a warning.

        It is counted by the error's reason, and also by its row if the error names the row.
        """
        with self._lock:  # called by the receiving thread and by the timekeeper
            self.account.dropped[error.reason.value] += 1
            if error.row:
                self.account.dropped_of_row[error.row, error.reason.value] += 1
        self.warnings.warn(error.reason.value, f"dropped: {error}")

    def count_unhandled(self, count: int) -> None:
        """Count datagrams that had arrived when the bridge stopped, but were not handled, as received and dropped."""
        if count:
            self.account.received += count
            self.account.dropped[Reason.STOPPED.value] += count

    def count_unsent(self, destination: Destination, error: OSError) -> None:
        """Count a datagram that was not sent, and log a warning, unless the state of the link has told the reason."""
        with self._lock:  # called by every thread of the bridge
            self.account.unsent[destination.end.peer] += 1
        if is_told_by_event(error):
            return
        self.warnings.warn(f"unsent {destination.end.peer}", f"cannot send to {destination}: {error.strerror}")

    def count_unforwarded(self, peer: str, size: int, allowed: int) -> None:
        """Count a datagram of ``size`` bytes that is too long to be forwarded to a peer, and log a warning."""
        with self._lock:
            self.account.unforwarded[peer] += 1
        self.warnings.warn(
            f"unforwarded {peer}",
            f"not forwarded to {peer}: a datagram of {size} bytes, but the peer's max_size is {allowed}",
        )

    def count_link_event(self, peer: str, board: str, event: str, text: str, level: int) -> None:
        """Count an event of the address of a peer or of its board, and log its text."""
        with self._lock:
            self.account.link_events[peer, board, event] += 1
        self.warnings.warn(f"{event} {peer} {board}", text, level)

    def read_kernel_drops(self) -> None:
        """Read how many datagrams the kernel has dropped for the socket, and log a warning if the number has grown."""
        before = self.account.kernel_drops
        self.account.kernel_drops = udp.kernel_drops(self._socket)
        if lost := self.account.kernel_drops - before:
            self.warnings.warn(
                "lost",
                f"the kernel dropped {counted(lost, 'datagram')}: more arrive than the bridge handles",
            )
