"""Counting what passes a bridge, with a warning for what is lost."""

from __future__ import annotations

import logging
import socket
import threading
import time

from roverlink.runtime.bridge.account import WARNING_INTERVAL_S, Account, ThrottledWarnings
from roverlink.runtime.core.errors import DatagramError, Reason
from roverlink.runtime.net import udp
from roverlink.runtime.net.destination import Destination


class Counters:
    """The account of a bridge, its warnings, and what the kernel drops at its socket. For all threads of the bridge."""

    def __init__(self, sock: socket.socket, logger: logging.Logger) -> None:
        self.account = Account()
        self.warnings = ThrottledWarnings(logger)
        self._socket = sock
        self._next_look = 0.0
        self._lock = threading.Lock()

    def receive(self, count: int) -> None:
        """Count datagrams taken from the socket; from time to time, look at what the kernel dropped there."""
        self.account.received += count
        if time.monotonic() >= self._next_look:
            self._next_look = time.monotonic() + WARNING_INTERVAL_S
            self.look_at_kernel_drops()

    def drop(self, error: DatagramError) -> None:
        """Count a datagram that is not bridged, by its reason and its row."""
        with self._lock:  # the receiving thread and the timekeeper's come here
            self.account.dropped[error.reason.value] += 1
            if error.row:
                self.account.dropped_of_row[error.row, error.reason.value] += 1
        self.warnings.warn(error.reason.value, f"dropped: {error}")

    def leave(self, count: int) -> None:
        """Count what had arrived when there was no time left to handle it."""
        if count:
            self.account.received += count
            self.account.dropped[Reason.STOPPED.value] += count

    def fail_to_send(self, destination: Destination, error: OSError) -> None:
        """Count a datagram that the network refused."""
        with self._lock:  # all threads come here
            self.account.unsent[destination.peer] += 1
        self.warnings.warn(f"unsent {destination.peer}", f"cannot send to {destination}: {error.strerror}")

    def look_at_kernel_drops(self) -> None:
        """Read how many datagrams the kernel dropped before they reached us, and warn where that has grown."""
        before = self.account.kernel_drops
        self.account.kernel_drops = udp.kernel_drops(self._socket)
        if lost := self.account.kernel_drops - before:
            self.warnings.warn("lost", f"the kernel dropped {lost} datagrams: they arrive faster than they are handled")
