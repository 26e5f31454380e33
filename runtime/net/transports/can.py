"""CAN: each datagram is a message of ISO-TP (ISO 15765-2), with an identifier for each direction.

The kernel speaks ISO-TP since Linux 5.10, if its module can-isotp is there. Without it, and with adapters that are no
network interfaces of the kernel, can-isotp speaks it over python-can (see `can_bus`).

The end says by flow control when the rest of a datagram may follow its first frame. If the end says nothing, it has not
taken the datagram (`NotTakenError`), but the line works: a board may be switched off while others on its bus are not.
"""

from __future__ import annotations

import errno
import os
import select
import socket
import struct
from collections import deque

from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.net.transports import Connection, NotTakenError
from roverlink.transport_addresses import KINDS, CanId, TransportAddress, can_id

# linux/can/isotp.h and linux/can.h
_ISOTP, _SOL_CAN_ISOTP = 6, 106
_OPTIONS, _LINK_OPTIONS = 1, 5
_WAIT_TX_DONE = 0x400
_FD_FRAME, _FD_DATA, _BIT_RATE_SWITCH = 72, 64, 1
_EXTENDED = 0x8000_0000
_NOT_TAKEN = (errno.ECOMM, errno.EMSGSIZE, errno.ENOBUFS)  # no flow control; no room at the end; no room here
_DAMAGED = (errno.EILSEQ, errno.ETIMEDOUT, errno.EBADMSG)  # a frame is missing, late, or not padded as it should be


class CanTransport:
    """ISO-TP on a CAN bus."""

    largest = KINDS["can"].largest

    def __init__(self, name: str, address: TransportAddress) -> None:
        """Raise `SetupError` if nobody knows the kind of bus, or if python-can is not installed."""
        self.name = name
        options = address.options
        self._place, self._bus = address.place, options.get("bus", "socketcan")
        self._bitrate = int(options["bitrate"]) if "bitrate" in options else None
        self._send, self._receive, self._fd = (
            can_id(options["send"]),
            can_id(options["receive"]),
            options.get("fd") == "1",
        )
        self._in_kernel = self._bus == "socketcan" and _kernel_speaks_isotp()
        if not self._in_kernel:
            try:
                from roverlink.runtime.net.transports import can_bus  # here: the kernel's ISO-TP needs no package
            except ImportError as error:
                command = "pip install python-can pyserial can-isotp"
                raise SetupError(f"CAN needs python-can and can-isotp; install them with `{command}`") from error
            can_bus.check_bus(name, self._bus)

    def connect(self) -> Connection:
        """Open the bus. Raises `OSError` if the interface or the adapter is not there."""
        if self._in_kernel:
            try:
                return KernelConnection(self._place, self._send, self._receive, self._fd)
            except OSError as error:
                raise OSError(f"{self._place}: {error.strerror}") from error
        from roverlink.runtime.net.transports.can_bus import BusConnection, opened_bus

        bus = opened_bus(self._bus, self._place, self._receive, self._fd, self._bitrate)
        return BusConnection(bus, self._send, self._receive, self._fd, self.largest)

    def close(self) -> None:
        """Do nothing: without a connection, nothing is open."""


class KernelConnection:
    """ISO-TP of the kernel."""

    def __init__(self, interface: str, send: CanId, receive: CanId, fd: bool) -> None:
        self.refused = 0
        self._untold = deque[OSError]()
        """Failures to send that the kernel has told the thread that receives."""
        self._socket = socket.socket(socket.AF_CAN, socket.SOCK_DGRAM, _ISOTP)
        try:
            # A call that sends returns when the end has the datagram. The other options keep what the kernel has.
            self._socket.setsockopt(_SOL_CAN_ISOTP, _OPTIONS, struct.pack("=LL4B", _WAIT_TX_DONE, 0, 0, 0xCC, 0xCC, 0))
            if fd:
                options = bytes((_FD_FRAME, _FD_DATA, _BIT_RATE_SWITCH))
                self._socket.setsockopt(_SOL_CAN_ISOTP, _LINK_OPTIONS, options)
            numbers = (one.number | _EXTENDED * one.is_extended for one in (receive, send))
            self._socket.bind((interface, *numbers))
            _raise_pending_error(self._socket)  # an interface that is down can be bound
        except OSError:
            self._socket.close()
            raise
        self._poll = select.poll()
        self._poll.register(self._socket, select.POLLIN)

    def receive(self, timeout: float) -> list[bytes]:
        """Return the datagrams that have arrived; wait at most ``timeout`` seconds for one."""
        datagrams: list[bytes] = []
        if self._poll.poll(timeout * 1000):
            while True:
                try:
                    datagrams.append(self._socket.recv(CanTransport.largest, socket.MSG_DONTWAIT))
                except BlockingIOError:
                    break
                except OSError as error:
                    if error.errno in _DAMAGED:
                        self.refused += 1
                    elif error.errno in _NOT_TAKEN:
                        self._untold.append(error)
                    else:
                        raise
        return datagrams

    def send(self, datagram: bytes) -> None:
        """Send a datagram. Raises `NotTakenError` if the end does not take all of its frames."""
        try:
            self._socket.send(datagram)
            if self._untold:
                raise self._untold.popleft()
        except OSError as error:
            if error.errno in _NOT_TAKEN:
                raise NotTakenError(error.errno, error.strerror) from error
            raise

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


def _raise_pending_error(sock: socket.socket) -> None:
    if number := sock.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR):
        raise OSError(number, os.strerror(number))


def _kernel_speaks_isotp() -> bool:
    try:
        socket.socket(socket.AF_CAN, socket.SOCK_DGRAM, _ISOTP).close()
    except (OSError, AttributeError):  # another system than Linux has no AF_CAN
        return False
    return True
