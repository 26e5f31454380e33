"""Serial lines: datagrams in frames with COBS and CRC-16 (see `framing`)."""

from __future__ import annotations

import contextlib
import errno
import glob
import os
import select
import termios
import time
from types import ModuleType

from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.net.transports import Connection
from roverlink.runtime.net.transports.framing import END, FrameReader, encode_frame
from roverlink.transport_addresses import KINDS, TransportAddress

_BAUD = "115200"
_BITS = 10  # of a byte on the line: with start and stop
_AHEAD_S = 0.005
"""Time in seconds that the line needs for what the kernel may still hold when `send` returns.

What the kernel holds, a command that is more important cannot overtake. Without anything, the line would be idle
between two datagrams.
"""
_HANGS_S = 1.0
"""Time in seconds after which a line that takes nothing is gone: a board whose program hangs reads no USB."""
_CHUNK = 65_536


class SerialTransport:
    """Serial device. Its path may be a pattern such as ``/dev/ttyACM*``: the first device that opens is used."""

    largest = KINDS["serial"].largest

    def __init__(self, name: str, address: TransportAddress) -> None:
        """Raise `SetupError` if pyserial is not installed."""
        self.name = name
        self._path, self._baud = address.place, int(address.options.get("baud", _BAUD))
        self._serial = _pyserial()

    def connect(self) -> Connection:
        """Open the device at once. Raises `OSError` if there is none, or if another program uses it."""
        # In the order of names, so that the choice does not change from start to start.
        paths = sorted(glob.glob(self._path))
        if not paths:
            raise FileNotFoundError(f"there is no {self._path}; connect the cable")
        failure = OSError()
        for path in paths:
            try:
                return SerialConnection(self._serial, path, self._baud, self.largest)
            except OSError as error:
                is_taken = error.errno in (errno.EAGAIN, errno.EBUSY)
                why = "another program uses it" if is_taken else os.strerror(error.errno) if error.errno else str(error)
                failure = OSError(error.errno or errno.EIO, f"{path}: {why}")
            except (ValueError, termios.error) as error:  # a baud rate that the driver does not have, or a file
                failure = OSError(errno.EINVAL, f"{path}: {error}")
        raise failure

    def close(self) -> None:
        """Do nothing: without a connection, nothing is open."""


class SerialConnection:
    """Open serial device."""

    def __init__(self, serial: ModuleType, path: str, baud: int, largest: int) -> None:
        longest_s = largest * _BITS / baud + _HANGS_S
        # Exclusive: two programs that read one line would each get a part of the bytes.
        self._device = serial.Serial(path, baud, timeout=0, write_timeout=longest_s, exclusive=True)
        self._baud = baud
        self._reader = FrameReader(largest)
        self._poll = select.poll()
        self._poll.register(self._device.fileno(), select.POLLIN)
        # It ends what the board may have got of an earlier frame.
        self._write(END)

    @property
    def refused(self) -> int:
        """Frames that were damaged."""
        return self._reader.refused

    def receive(self, timeout: float) -> list[bytes]:
        """Return the datagrams that have arrived; wait at most ``timeout`` seconds for bytes."""
        if not self._poll.poll(timeout * 1000):
            return []
        # Not by pyserial: it takes two system calls more for the same bytes.
        try:
            received = os.read(self._device.fileno(), _CHUNK)
        except BlockingIOError:
            return []
        if not received:
            raise OSError("the device is gone")
        return self._reader.take(received)

    def send(self, datagram: bytes) -> None:
        """Send a datagram, and wait until the line has almost taken it."""
        try:
            self._write(encode_frame(datagram))
            self._wait_until_taken()
        except OSError:
            # A board that reads again must not get old commands, also while we close.
            with contextlib.suppress(OSError, termios.error):  # the device is gone
                self._device.reset_output_buffer()
            raise

    def close(self) -> None:
        """Close the device."""
        self._device.close()

    def _waiting_s(self) -> float:
        """Return the time that the line needs for what the kernel still holds."""
        waiting: int = self._device.out_waiting
        return waiting * _BITS / self._baud

    def _wait_until_taken(self) -> None:
        deadline = time.monotonic() + self._waiting_s() + _HANGS_S
        while (late := self._waiting_s() - _AHEAD_S) > 0:
            if time.monotonic() > deadline:
                raise OSError("the device takes no bytes")
            time.sleep(min(late, _AHEAD_S))  # over USB, the baud rate means nothing, and the bytes are gone at once

    def _write(self, data: bytes) -> None:
        self._device.write(data)  # it raises an OSError of pyserial if the device does not take the data in time


def _pyserial() -> ModuleType:
    try:
        import serial
    except ImportError as error:
        raise SetupError("a serial line needs pyserial; install it with `pip install pyserial`") from error
    return serial
