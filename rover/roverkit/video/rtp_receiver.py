"""Receiver of a stream in RTP packets, which reports to its sender in RTCP packets."""

from __future__ import annotations

import contextlib
import secrets
import select
import time
from collections.abc import Iterator
from dataclasses import dataclass

from roverkit.video.h264 import NalType, is_key_frame, nal_type, stamp_of
from roverkit.video.reordering import Arrivals, Reordering
from roverkit.video.rtcp import (
    Missing,
    PictureLoss,
    ReceiverReport,
    SenderReport,
    is_rtcp,
    middle_of,
    read_reports,
)
from roverkit.video.rtp import AccessUnit, Depacketizer, RtpPacket, read_packet
from roverlink.runtime.net.hosts import SocketAddress, sender_at, text_of
from roverlink.runtime.net.udp import bind

_BUFFER = 1 << 20
_REPORT_S = 0.5
_KEY_AGAIN_S = 0.3
SILENT_S = 0.5
"""Time in seconds without a packet after which a sender counts as gone, and another one may take its place."""
_WAKE_S = 0.1
_LARGEST = 65_536


@dataclass(frozen=True, slots=True, eq=False)
class ReceivedUnit:
    """Encoded image that was received."""

    nals: list[bytes]
    timestamp: int
    """Time of the image in units of 1/90000 s, extended beyond 32 bits, from a start of the sender's choice."""
    stamp: int | None
    """Time of the image in nanoseconds since 1970 by the sender's clock; None if the sender does not tell it."""
    key: bool
    """True if it can be decoded without others."""
    intact: bool
    """True if nothing of it is missing, and nothing of the images from which it is decoded."""
    restarted: bool
    """True for the first one of a run of the sender."""


class RtpReceiver:
    """Receiver of one stream on a UDP port. A context manager that closes the port."""

    def __init__(self, address: str, port: int) -> None:
        """Bind the port. Raises `SetupError` if it is in use."""
        self._socket = bind(address, port, _BUFFER)
        self._socket.setblocking(False)
        self.port: int = self._socket.getsockname()[1]
        self._ssrc = secrets.randbits(32)
        self._source: SocketAddress | None = None
        self._heard = -SILENT_S
        self._closed = False
        self._begin()

    @property
    def arrivals(self) -> Arrivals:
        """Counts of the packets of the sender's present run."""
        return self._order.arrivals

    @property
    def source(self) -> str:
        """Address of the sender as text; empty if nothing was received."""
        return text_of(sender_at(self._source).address) if self._source else ""

    def units(self) -> Iterator[ReceivedUnit | None]:
        """Yield the access units as they come, and None at least ten times a second, until the receiver is closed."""
        while not self._closed:
            yield from self._wait()
            self._request()
            yield None

    def close(self) -> None:
        """End the iteration of `units`; safe to call from another thread."""
        self._closed = True

    def __enter__(self) -> RtpReceiver:
        return self

    def __exit__(self, *_: object) -> None:
        self._closed = True
        self._socket.close()

    def _begin(self) -> None:
        """Begin with another run of a sender."""
        self._order, self._units = Reordering(), Depacketizer()
        self._intact, self._restarted = False, True
        self._key_asked = self._last_report = -_KEY_AGAIN_S
        self._reported = (0, 0)
        self._sender_report: tuple[SenderReport, float] | None = None
        self._timestamp: int | None = None

    def _wait(self) -> Iterator[ReceivedUnit]:
        """Wait for datagrams, and yield the access units that they complete."""
        due = self._order.next_due()
        wait = _WAKE_S if due is None else min(max(due - time.monotonic_ns(), 0) / 1e9, _WAKE_S)
        ready, _, _ = select.select([self._socket], [], [], wait)
        while ready:
            try:
                data, address = self._socket.recvfrom(_LARGEST)
            except BlockingIOError:
                break
            except OSError:  # an earlier report was refused
                continue
            yield from self._take(data, address)
        yield from self._ended(self._order.due(time.monotonic_ns()))

    def _take(self, data: bytes, address: SocketAddress) -> Iterator[ReceivedUnit]:
        now = time.monotonic()
        if is_rtcp(data):
            for report in read_reports(data):
                if isinstance(report, SenderReport) and report.ssrc == self._order.ssrc:
                    self._sender_report = report, now
            return
        packet = read_packet(data)
        if packet is None:
            return
        # The images of two senders on one port would replace each other all the time.
        if self._order.ssrc not in (None, packet.ssrc) and now - self._heard < SILENT_S:
            return
        if self._order.begins(packet):
            self._begin()
        self._heard, self._source = now, address
        yield from self._ended(self._order.add(packet, time.monotonic_ns()))

    def _ended(self, packets: Iterator[tuple[RtpPacket, int]]) -> Iterator[ReceivedUnit]:
        for packet, lost in packets:
            if lost:
                self._intact = False
            for unit in self._units.add(packet, lost):
                yield self._unit(unit)

    def _unit(self, unit: AccessUnit) -> ReceivedUnit:
        # A packet that is missing between two units belongs to one of them, and `complete` is false for one of them.
        key = is_key_frame(unit.nals)
        if not unit.complete:
            self._intact = False
        elif key and any(nal_type(nal) == NalType.SPS for nal in unit.nals):
            self._intact = True
        restarted, self._restarted = self._restarted, False
        last = unit.timestamp if self._timestamp is None else self._timestamp
        self._timestamp = last + ((unit.timestamp - last + 2**31) % 2**32 - 2**31)
        return ReceivedUnit(unit.nals, self._timestamp, stamp_of(unit.nals), key, self._intact, restarted)

    def _request(self) -> None:
        """Send the requests and the report that are due to the sender."""
        ssrc, now = self._order.ssrc, time.monotonic()
        if ssrc is None or self._source is None:
            return
        if wanted := self._order.wanted(time.monotonic_ns()):
            self._send(Missing(self._ssrc, ssrc, tuple(wanted)).encode())
        if now - self._last_report >= _REPORT_S and now - self._heard < SILENT_S:
            self._last_report = now
            self._send(self._receiver_report(ssrc, now).encode())
        # Before the first image is complete, nobody knows if it is a key frame.
        broken = not self._intact and not self._restarted
        if broken and now - self._key_asked >= _KEY_AGAIN_S and now - self._heard < SILENT_S:
            self._key_asked = now
            self._send(PictureLoss(self._ssrc, ssrc).encode())

    def _receiver_report(self, ssrc: int, now: float) -> ReceiverReport:
        arrivals = self._order.arrivals
        received, lost = arrivals.received - self._reported[0], arrivals.lost - self._reported[1]
        self._reported = arrivals.received, arrivals.lost
        last, delay = 0, 0
        if self._sender_report:
            report, at = self._sender_report
            last, delay = middle_of(report.ntp), int((now - at) * 65536)
        fraction = lost / max(received + lost, 1)
        return ReceiverReport(
            self._ssrc, ssrc, fraction, arrivals.lost, arrivals.highest & 0xFFFFFFFF, int(arrivals.jitter), last, delay
        )

    def _send(self, data: bytes) -> None:
        if self._source is not None:
            with contextlib.suppress(OSError):  # the sender is gone, which the silence tells
                self._socket.sendto(data, self._source)
