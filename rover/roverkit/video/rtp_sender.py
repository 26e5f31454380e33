"""Sender of a stream in RTP packets, with what its receiver reports in RTCP packets."""

from __future__ import annotations

import contextlib
import secrets
import socket
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Sequence

from roverkit.video.h264 import with_stamp
from roverkit.video.packet_pacing import PacedLink
from roverkit.video.rtcp import (
    Missing,
    PictureLoss,
    ReceiverReport,
    SenderReport,
    is_rtcp,
    middle_of,
    ntp_of,
    read_reports,
)
from roverkit.video.rtp import CLOCK_HZ, RtpPacket, payloads
from roverlink.runtime.net.hosts import SocketAddress, family_of, sender_at
from roverlink.runtime.net.traffic_class import TrafficClass, mark

LARGEST_PACKET = 1200
"""Largest RTP packet in bytes: with headers, it fits into the MTU of VPNs and of most radios."""
_REMEMBERED = 1024  # packets that can be sent again
_REPORT_S = 1.0
_WAKE_S = 0.2

Reported = Callable[[float, float | None], None]
"""Function that gets the part of packets that were lost recently, and the round trip in seconds or None."""


class RtpSender:
    """Sender of one stream to one address. A context manager: it listens to the receiver inside the block."""

    def __init__(self, address: SocketAddress, link: PacedLink, reported: Reported) -> None:
        """Send to an address through a link; `reported` is called, on another thread, with what a receiver reports."""
        self.lost = 0
        """Packets that the receiver has lost, by its last report."""
        self.refusal: OSError | None = None
        """Reason why the network refused the last packet; None if it took it."""
        self.key_wanted = False
        """True after the receiver has asked for a key frame; the one who encodes it sets this to false."""
        self._address, self._link, self._reported = address, link, reported
        self._socket = socket.socket(family_of(address), socket.SOCK_DGRAM)
        self._socket.settimeout(_WAKE_S)
        mark(self._socket, TrafficClass.VIDEO)
        self._ssrc, self._sequence = secrets.randbits(32), secrets.randbits(16)
        self._origin = secrets.randbits(32)
        self._sent: OrderedDict[int, bytes] = OrderedDict()
        self._lock = threading.Lock()
        self._packets = self._octets = 0
        self._receiver: SocketAddress | None = None
        self._next_report = 0.0
        self._ended = False
        self._thread = threading.Thread(target=self._listen, name="rtcp", daemon=True)

    def send(self, nals: Sequence[bytes], stamp: int) -> int:
        """Send an access unit whose image was taken at `stamp`, in nanoseconds since 1970; return its bytes."""
        timestamp = self._timestamp(stamp)
        parts = payloads(with_stamp(nals, stamp), LARGEST_PACKET - 12)
        packets = []
        with self._lock:
            for index, part in enumerate(parts):
                data = RtpPacket(self._sequence, timestamp, self._ssrc, index == len(parts) - 1, part).encode()
                self._sent[self._sequence] = data
                self._sequence = (self._sequence + 1) & 0xFFFF
                packets.append(data)
            while len(self._sent) > _REMEMBERED:
                self._sent.popitem(last=False)
            self._packets += len(packets)
            self._octets += sum(map(len, parts))
        self._link.add(self._send_now, packets)
        self._report()
        return sum(map(len, packets))

    def __enter__(self) -> RtpSender:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended = True
        self._thread.join()
        self._socket.close()

    def _timestamp(self, stamp: int) -> int:
        return (self._origin + stamp * (CLOCK_HZ // 1000) // 10**6) & 0xFFFFFFFF

    def _send_now(self, packet: bytes) -> None:
        try:
            self._socket.sendto(packet, self._address)
            self.refusal = None
        except OSError as error:
            self.refusal = error

    def _report(self) -> None:
        """Send a sender report now and then, but only to a receiver that understands RTCP on this port."""
        now = time.monotonic()
        if self._receiver is None or now < self._next_report:
            return
        self._next_report = now + _REPORT_S
        stamp = time.time_ns()
        report = SenderReport(
            self._ssrc, ntp_of(stamp), self._timestamp(stamp), self._packets, self._octets & 0xFFFFFFFF
        )
        with contextlib.suppress(OSError):  # as for the packets, which tell it
            self._socket.sendto(report.encode(), self._receiver)

    def _listen(self) -> None:
        while not self._ended:
            try:
                data, address = self._socket.recvfrom(2048)
            except OSError:  # nothing came, or an earlier packet was refused
                continue
            # Only the receiver of the video may slow it down.
            if is_rtcp(data) and sender_at(address).ip == sender_at(self._address).ip:
                self._receiver = address
                for report in read_reports(data):
                    self._take(report)

    def _take(self, report: object) -> None:
        if isinstance(report, PictureLoss) and report.source == self._ssrc:
            self.key_wanted = True
        elif isinstance(report, Missing) and report.source == self._ssrc:
            with self._lock:
                again = [self._sent[sequence] for sequence in report.sequences if sequence in self._sent]
            self._link.add(self._send_now, again, first=True)
        elif isinstance(report, ReceiverReport) and report.source == self._ssrc:
            self.lost = report.lost
            self._reported(report.fraction_lost, _round_trip(report))


def _round_trip(report: ReceiverReport) -> float | None:
    """Return the round trip in seconds (RFC 3550, 6.4.1); None if the receiver has had no report of ours."""
    if not report.last_report:
        return None
    units = (middle_of(ntp_of(time.time_ns())) - report.last_report - report.delay) & 0xFFFFFFFF
    return units / 65536 if units < 2**31 else 0.0
