"""Stream that is received: its thread decodes the images, saves them, publishes them, and counts."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from roverkit.video.decoder import Decoder
from roverkit.video.rtp_receiver import ReceivedUnit, RtpReceiver
from roverkit.vision.markers.detection import Image
from roverkit.vision.opencv import cv2

STALE_S = 1.0
"""Age in seconds of the newest image from which a stream counts as stale."""
_QUALITY = 80  # of JPEG
_WINDOW_S = 2.0
_NONSENSE_S = 60.0  # a latency above this is a difference of the clocks
_JOIN_S = 2.0

TakeUnit = Callable[[ReceivedUnit], None]
TakeImage = Callable[[Image, int], None]


@dataclass(frozen=True, slots=True)
class _Arrival:
    at: float
    octets: int
    intact: bool
    latency: float | None


class ReceivedStream:
    """One stream with its thread. A context manager."""

    def __init__(self, name: str, receiver: RtpReceiver, save: TakeUnit, publish: TakeImage) -> None:
        """Receive; `save` gets each encoded image, `publish` each decoded one with its time in nanoseconds.

        If one of them raises, the stream ends, and `problem` is the error.
        """
        self.name = name
        self._receiver, self._save, self._publish = receiver, save, publish
        self._news = threading.Condition()
        self._image: Image | None = None
        self._number = 0
        self._jpeg: tuple[int, bytes] = (0, b"")
        self._at: float | None = None
        self._recent: deque[_Arrival] = deque()
        self._failure: Exception | None = None
        self._ended = False
        self._thread = threading.Thread(target=self._run, name=f"video-{name}", daemon=True)

    def next_jpeg(self, after: int, timeout_s: float) -> tuple[int, bytes] | None:
        """Return the number and the JPEG of the newest image, if its number is larger than `after`; wait for it.

        Returns None if there is no new image in time, or at the end.
        """
        with self._news:
            self._news.wait_for(lambda: self._number > after or self._ended, timeout_s)
            if self._number <= after or self._image is None or self._ended:
                return None
            image, number = self._image, self._number
            if self._jpeg[0] == number:
                return self._jpeg
        # Several browsers may do this at once, which costs time, but does not hold up the thread of the stream.
        done, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])
        if not done:
            return None
        self._jpeg = number, data.tobytes()
        return self._jpeg

    def state(self) -> dict[str, Any]:
        """Return the state for the page and for JSON: times in seconds, rates a second, shares from 0 to 1."""
        now = time.monotonic()
        with self._news:
            recent = [arrival for arrival in self._recent if now - arrival.at <= _WINDOW_S]
            age = None if self._at is None else now - self._at
            size = None if self._image is None else list(self._image.shape[1::-1])
        arrivals = self._receiver.arrivals
        latencies = sorted(arrival.latency for arrival in recent if arrival.latency is not None)
        packets = arrivals.received + arrivals.lost
        return {
            "name": self.name,
            "port": self._receiver.port,
            "source": self._receiver.source,
            "size": size,
            "age": None if age is None else round(age, 3),
            "stale": age is None or age > STALE_S,
            "rate": round(len(recent) / _WINDOW_S, 1),
            "kbit_s": round(sum(arrival.octets for arrival in recent) * 8 / 1000 / _WINDOW_S),
            "intact": round(sum(arrival.intact for arrival in recent) / len(recent), 3) if recent else None,
            "lost": round(arrivals.lost / packets, 4) if packets else None,
            "lost_packets": arrivals.lost,
            "repaired_packets": arrivals.repaired,
            "latency": round(latencies[len(latencies) // 2], 4) if latencies else None,
        }

    @property
    def ended(self) -> bool:
        """True after the end, when there are no more images."""
        return self._ended

    @property
    def problem(self) -> Exception | None:
        """Error that has ended the stream; None while it runs."""
        return self._failure

    def __enter__(self) -> ReceivedStream:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._receiver.close()
        self._thread.join(_JOIN_S)
        with self._news:
            self._ended = True
            self._news.notify_all()

    def _run(self) -> None:
        decoder = Decoder()
        try:
            for unit in self._receiver.units():
                if unit is None:
                    continue
                if unit.restarted:
                    decoder = Decoder()
                self._save(unit)
                image = decoder.decode(unit.nals)
                if image is not None:
                    self._take(image, unit)
        except Exception as error:  # noqa: BLE001  # the main thread tells it
            self._failure = error

    def _take(self, image: Image, unit: ReceivedUnit) -> None:
        now = time.monotonic()
        latency = None if unit.stamp is None else (time.time_ns() - unit.stamp) / 1e9
        if latency is not None and abs(latency) > _NONSENSE_S:
            latency = None
        with self._news:
            self._image, self._at = image, now
            self._number += 1
            self._recent.append(_Arrival(now, sum(map(len, unit.nals)), unit.intact, latency))
            while now - self._recent[0].at > _WINDOW_S:
                self._recent.popleft()
            self._news.notify_all()
        self._publish(image, unit.stamp or time.time_ns())
