"""Outputs of a stream: the images are encoded and sent."""

from __future__ import annotations

import math
import time
from collections import deque
from dataclasses import dataclass
from typing import Protocol

from roverkit.video.encoder import Encoder, check_encoder
from roverkit.video.image_rate import ImageRate
from roverkit.video.packet_pacing import PacedLink
from roverkit.video.rate_control import RateControl
from roverkit.video.rtp import CLOCK_HZ
from roverkit.video.rtp_sender import RtpSender
from roverkit.video.stream_settings import StreamSettings
from roverkit.vision.frames.frame import size_of
from roverkit.vision.markers.detection import Image
from roverlink.runtime.net.hosts import SocketAddress

KEY_S = 1.0
"""Longest time in seconds between two key frames: a receiver that joins late sees nothing before one."""
_KEY_AGAIN_S = 0.25
"""Least time between two key frames, however often receivers ask for them."""
_FULL_S = 0.1
"""Time that packets wait for the link, from which images are left out: an older image is of no use."""
_OTHER_RATE = 1.15
"""Factor by which the rate of the images must differ from that of the encoder before it is opened again."""
_QUIET_S = 3.0
"""Time without a report of the receiver after which what the link measures counts."""


@dataclass(slots=True)
class Sent:
    """Counts of a stream since the start."""

    images: int = 0
    skipped: int = 0
    """Images that were left out because the link was full."""
    octets: int = 0
    lost: int = 0
    """Packets that the receiver has lost."""
    round_trip: float | None = None
    """Time in seconds to the receiver and back; None if it does not report."""


class VideoOutput(Protocol):
    """Output of a stream. A context manager."""

    sent: Sent

    @property
    def divisor(self) -> int:
        """1 if the link takes all images; 2 if every other one should be left out."""

    def put(self, image: Image, stamp: int) -> None:
        """Encode and send an image (H, W[, 3]) with even sides, taken at `stamp`, in nanoseconds since 1970."""

    def limit(self, lowest: float, highest: float) -> None:
        """Keep the bitrate between two others, in kbit/s, from the next image on."""

    def link_measured(self, lost: float, round_trip: float | None) -> None:
        """Take what the link measures, which counts if the receiver itself does not report."""

    def refusal(self) -> str:
        """Return the reason why nothing can be sent at present; empty if it can."""

    def __enter__(self) -> VideoOutput: ...

    def __exit__(self, *_: object) -> None: ...


class RtpOutput:
    """Output that encodes images with x264, and sends them as RTP packets."""

    def __init__(self, settings: StreamSettings, address: SocketAddress, link: PacedLink) -> None:
        """Send to an address through a link. Raises `SetupError` if there is no encoder."""
        check_encoder()
        self.sent = Sent()
        self._settings, self._link = settings, link
        self._highest = 1e3 * settings.bitrate
        self._control = RateControl(1e3 * settings.min_bitrate, self._highest)
        self._rate = ImageRate(settings.rate)
        # Other threads append what arrives, and `put` takes it.
        self._reports: deque[tuple[float, float | None]] = deque(maxlen=8)
        self._reported_at = -math.inf
        self._sender = RtpSender(address, link, self._receiver_reported)
        self._encoder: Encoder | None = None
        self._start = self._last = 0
        self._key_at = -KEY_S

    @property
    def divisor(self) -> int:
        """1 if the link takes all images; 2 if every other one should be left out."""
        return self._control.plan.divisor

    def put(self, image: Image, stamp: int) -> None:
        """Encode and send an image, or leave it out if the link is full. Raises `SetupError` if the encoder fails."""
        self._take_reports()
        plan = self._control.plan
        self._rate.add(stamp, plan.divisor)
        if self._link.delay > _FULL_S:
            self.sent.skipped += 1
            return
        now = time.monotonic()
        wait = _KEY_AGAIN_S if self._sender.key_wanted else KEY_S
        # Half an image earlier, so that key frames are not one image too late again and again.
        key = now - self._key_at >= wait - 0.5 / self._rate.hz
        encoder = self._encoder
        if encoder is None or encoder.size != size_of(image) or (key and not self._has_rate(encoder)):
            encoder = self._encoder = Encoder(size_of(image), self._rate.hz, self._highest)
            self._start, self._last, key = stamp, -1, True
        if key:
            self._key_at = now
            self._sender.key_wanted = False
        # The encoder reckons with the rate of the source. If half of the images are left out, each keeps its bits.
        encoder.set_bitrate(plan.bitrate * plan.divisor)
        timestamp = max((stamp - self._start) * CLOCK_HZ // 10**9, self._last + 1)
        self._last = timestamp
        nals = encoder.encode(image, timestamp, key=key)
        self.sent.images += 1
        self.sent.octets += self._sender.send(nals, stamp)

    def _has_rate(self, encoder: Encoder) -> bool:
        """Return true if the images come at about the rate of an encoder."""
        return 1 / _OTHER_RATE < self._rate.hz / encoder.rate < _OTHER_RATE

    def limit(self, lowest: float, highest: float) -> None:
        """Keep the bitrate between two others, in kbit/s, from the next image on."""
        self._highest = 1e3 * highest
        self._control = RateControl(1e3 * lowest, self._highest)
        self._encoder = None  # its own limit is that of the begin

    def link_measured(self, lost: float, round_trip: float | None) -> None:
        """Take what the link measures, which counts if the receiver itself does not report."""
        if time.monotonic() - self._reported_at > _QUIET_S:
            self._reports.append((lost, round_trip))

    def refusal(self) -> str:
        """Return the reason why nothing can be sent at present; empty if it can."""
        return str(self._sender.refusal.strerror) if self._sender.refusal else ""

    def __enter__(self) -> RtpOutput:
        self._sender.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        self._sender.__exit__()

    def _receiver_reported(self, lost: float, round_trip: float | None) -> None:
        self._reported_at = time.monotonic()
        self._reports.append((lost, round_trip))

    def _take_reports(self) -> None:
        now = time.monotonic()
        while self._reports:
            lost, round_trip = self._reports.popleft()
            self._control.report(lost, round_trip, now)
            self.sent.round_trip = round_trip
        self.sent.lost = self._sender.lost
