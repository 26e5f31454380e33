"""ISO-TP in this process: by can-isotp, over any bus of python-can. Needs both packages."""

from __future__ import annotations

import contextlib
import errno
import time
from typing import Any

import can
import isotp

from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.net.transports import NotTakenError
from roverlink.suggestions import nearest
from roverlink.transport_addresses import CanId

_TAKEN_WITHIN_S = 5.0
"""Longest time in seconds for a datagram: the end may ask for pauses between its frames."""
_FLOW_CONTROL_S = 0.25
"""Longest time in seconds for the flow control of the end. No other datagram can leave meanwhile."""
_NEXT_FRAME_S = 1.0
"""Longest time in seconds between two frames of a datagram that arrives."""
_ROOM_S = 2.0
"""Longest time in seconds for the adapter to have room for a frame. A busy computer stood still for 0.5 s."""
_PAUSE_S = 0.001
_POLL_S = 0.02
"""Longest wait in seconds of can-isotp's threads, before they look whether a timeout is over."""
_MOST_WAITS = 10
_DAMAGES = (
    isotp.errors.ConsecutiveFrameTimeoutError,
    isotp.errors.WrongSequenceNumberError,
    isotp.errors.ReceptionInterruptedWithSingleFrameError,
    isotp.errors.ReceptionInterruptedWithFirstFrameError,
    isotp.errors.InvalidCanDataError,
    isotp.errors.FrameTooLongError,
    isotp.errors.MissingEscapeSequenceError,
    isotp.errors.InvalidCanFdFirstFrameRXDL,
)
"""Errors of can-isotp that end a datagram. It has one more for each of the datagram's frames that still come."""


def check_bus(name: str, bus: str) -> None:
    """Raise `SetupError` if python-can does not know the kind of ``bus`` in the address ``name``."""
    if bus not in can.VALID_INTERFACES:
        raise SetupError(f"{name!r}: python-can has no bus {bus!r}; {nearest(bus, sorted(can.VALID_INTERFACES))}")


def opened_bus(kind: str, place: str, receive: CanId, fd: bool, bitrate: int | None) -> can.BusABC:
    """Return an open bus, which gives only the frames for this end. Raises `OSError` if it cannot be opened."""
    given: dict[str, Any] = {"fd": True} if fd else {}
    if bitrate is not None:
        given["bitrate"] = bitrate
    mine = {"can_id": receive.number, "can_mask": 0x1FFF_FFFF, "extended": receive.is_extended}
    try:
        return can.Bus(channel=place, interface=kind, can_filters=[mine], **given)
    # Adapters raise more than errors of CAN, such as ImportError for the library of their vendor.
    except Exception as error:
        has_none = isinstance(error, OSError) and error.errno == errno.EAFNOSUPPORT
        why = "the kernel of this computer has no CAN" if has_none else getattr(error, "strerror", None) or error
        raise OSError(f"{place}: {why}") from error


class BusConnection:
    """ISO-TP of can-isotp on a bus of python-can."""

    def __init__(self, bus: can.BusABC, send: CanId, receive: CanId, fd: bool, largest: int) -> None:
        self.refused = 0
        self._bus = bus
        self._broken: Exception | None = None
        modes = {False: isotp.AddressingMode.Normal_11bits, True: isotp.AddressingMode.Normal_29bits}
        address = isotp.AsymmetricAddress(
            tx_addr=isotp.Address(modes[send.is_extended], txid=send.number, tx_only=True),
            rx_addr=isotp.Address(modes[receive.is_extended], rxid=receive.number, rx_only=True),
        )
        parameters = {
            "can_fd": fd,
            "bitrate_switch": fd,
            "tx_data_length": 64 if fd else 8,
            "max_frame_size": largest,
            "rx_flowcontrol_timeout": int(_FLOW_CONTROL_S * 1000),
            "rx_consecutive_frame_timeout": int(_NEXT_FRAME_S * 1000),
            "wftmax": _MOST_WAITS,
            "blocking_send": True,
            "logger_name": "roverlink.isotp",
        }
        self._layer = isotp.TransportLayer(
            self._take,
            self._put,
            address,  # type: ignore[arg-type]  # the annotation has forgotten this class
            self._on_error,
            parameters,
            _POLL_S,
        )
        self._layer.logger.disabled = True  # it has a line for each damage, and we count them
        try:
            self._layer.start()
        except RuntimeError as error:  # its threads have half a second to start, which is short on a busy computer
            self.close()
            raise OSError(str(error)) from error

    def receive(self, timeout: float) -> list[bytes]:
        """Return the datagrams that have arrived; wait at most ``timeout`` seconds for one."""
        datagram = self._layer.recv(block=True, timeout=timeout)
        datagrams = []
        while datagram:
            datagrams.append(bytes(datagram))
            datagram = self._layer.recv()
        if not datagrams:
            self._raise_if_broken()
        return datagrams

    def send(self, datagram: bytes) -> None:
        """Send a datagram. Raises `NotTakenError` if the end does not take all of its frames."""
        self._raise_if_broken()
        try:
            self._layer.send(datagram, send_timeout=_TAKEN_WITHIN_S)
        except isotp.BlockingSendFailure as error:
            self._raise_if_broken()
            self._layer.stop_sending()
            raise NotTakenError("the end does not take the datagram") from error
        self._raise_if_broken()

    def close(self) -> None:
        """Close the bus."""
        self._break(OSError("the bus is closed"))
        self._layer.stop()
        with contextlib.suppress(Exception):  # slcan says goodbye to an adapter that is gone
            self._bus.shutdown()

    def _raise_if_broken(self) -> None:
        if self._broken is not None:
            raise OSError(str(self._broken)) from self._broken

    def _break(self, failure: Exception) -> None:
        self._broken = self._broken or failure
        self._layer.rx_queue.put(bytearray())  # it wakes `receive`

    # The threads of can-isotp call what follows, and would silently end with an exception. Adapters raise more than
    # errors of CAN: slcan raises ValueError for a damaged line, for example.

    def _take(self, timeout: float) -> isotp.CanMessage | None:
        try:
            frame = self._bus.recv(timeout)
        except Exception as error:  # noqa: BLE001  # see above
            self._break(error)
            return None
        if frame is None or frame.is_error_frame or frame.is_remote_frame:
            return None
        return isotp.CanMessage(
            arbitration_id=frame.arbitration_id,
            data=bytes(frame.data),
            extended_id=frame.is_extended_id,
            is_fd=frame.is_fd,
        )

    def _put(self, frame: isotp.CanMessage) -> None:
        message = can.Message(
            arbitration_id=frame.arbitration_id,
            data=frame.data,
            is_extended_id=frame.is_extended_id,
            is_fd=frame.is_fd,
            bitrate_switch=frame.bitrate_switch,
        )
        deadline = time.monotonic() + _ROOM_S
        while self._broken is None:
            try:
                self._bus.send(message, _ROOM_S)
            except Exception as error:  # noqa: BLE001  # see above
                # A socket of SocketCAN is writable even if the queue of the interface has no room.
                is_full = errno.ENOBUFS in (getattr(error, "error_code", None), getattr(error, "errno", None))
                if not is_full or time.monotonic() > deadline:
                    self._break(error)
                time.sleep(_PAUSE_S)
            else:
                return

    def _on_error(self, error: Exception) -> None:
        self.refused += isinstance(error, _DAMAGES)
