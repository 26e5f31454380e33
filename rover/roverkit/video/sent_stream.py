"""Stream that is sent: a thread takes the newest frame of a source, and gives it to the output."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import replace

from roverkit.video.stream_settings import StreamSettings
from roverkit.video.video_output import Sent, VideoOutput
from roverkit.vision.frames import Frame, FrameSource, play
from roverkit.vision.frames.interleaving import newest
from roverkit.vision.markers.detection import Image
from roverlink.runtime.core.errors import MiddlewareError, SetupError
from roverlink.runtime.ros_time.clock import Clock

PAUSE_S = 0.5
"""Time in seconds after which a source that could not be opened is tried again."""
_WORKED = 30
"""Number of images after which a source that fails has worked before."""
_SAID_S = 5.0
_JOIN_S = 2.0

OpenSource = Callable[[StreamSettings], FrameSource]
OpenOutput = Callable[[StreamSettings], VideoOutput]
Prepare = Callable[[Frame, StreamSettings], Image]
"""Function that returns the image to send for a frame: of the stream's size, with its overlay."""
_REOPENING = ("source", "host", "port", "running", "pipeline", "camera")


class SentStream:
    """One stream with its thread. A context manager."""

    def __init__(
        self,
        settings: StreamSettings,
        open_source: OpenSource,
        open_output: OpenOutput,
        prepare: Prepare,
        clock: Clock,
        say: Callable[[str], None],
        *,
        loop: bool,
    ) -> None:
        """Prepare the stream. With `loop`, a recording is played again and again.

        `say` is called with messages for the user.
        """
        self._settings, self._loop, self._clock = settings, loop, clock
        self._open_source, self._open_output, self._prepare, self._say = open_source, open_output, prepare, say
        self._news = threading.Condition()
        self._ending = False
        self._opened = ExitStack()
        self._source: FrameSource | None = None
        self._output: VideoOutput | None = None
        self._said = 0.0
        self.finished = threading.Event()
        """Set while the source has ended, and no other one is wanted."""
        self._thread = threading.Thread(target=self._run, name=f"video-{settings.name}", daemon=True)

    @property
    def settings(self) -> StreamSettings:
        """Present settings."""
        return self._settings

    @property
    def sent(self) -> Sent:
        """Counts since the output was opened."""
        output = self._output
        return output.sent if output else Sent()

    def open(self) -> None:
        """Open the source and the output now. Raises `SetupError` if one of them cannot be opened."""
        if self._settings.running:
            self._open(self._settings)

    def change(self, settings: StreamSettings) -> None:
        """Use other settings from the next image on; the source is opened again if it is another one."""
        with self._news:
            before, self._settings = self._settings, settings
            source = self._source if _reopens(before, settings) else None
            self._news.notify_all()
        _end(source)

    def link_measured(self, lost: float, round_trip: float | None) -> None:
        """Take what the link measures: the part of datagrams that were lost recently, and the round trip in seconds."""
        if output := self._output:
            output.link_measured(lost, round_trip)

    def __enter__(self) -> SentStream:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        with self._news:
            self._ending = True
            source = self._source
            self._news.notify_all()
        _end(source)
        self._thread.join(_JOIN_S)  # a camera that hangs must not keep the program
        self._opened.close()

    def _open(self, settings: StreamSettings) -> None:
        with ExitStack() as stack:
            output = stack.enter_context(self._open_output(settings))
            source = stack.enter_context(self._open_source(settings))
            self._opened = stack.pop_all()
        with self._news:
            self._source, self._output = source, output

    def _run(self) -> None:
        last = ""
        while not self._ending:
            settings = self._settings
            try:
                if self._source is None and settings.running:
                    self._open(settings)
                if self._source is not None and self._output is not None:
                    self._send(self._source, self._output, settings)
                    if self._is_current(settings) and not self._ending:
                        self.finished.set()
            except (SetupError, MiddlewareError) as error:
                if str(error) != last or self.sent.images >= _WORKED:
                    self._say(f"{settings.name}: {error}; trying again and again")
                last = str(error)
                self._wait(PAUSE_S, settings)
            finally:
                with self._news:
                    self._source = self._output = None
                self._opened.close()
            if self.finished.is_set() or not settings.running:
                self._wait(None, settings)
                self.finished.clear()

    def _wait(self, timeout: float | None, settings: StreamSettings) -> None:
        """Wait for other settings, or for the end."""
        with self._news:
            self._news.wait_for(lambda: self._ending or not self._is_current(settings), timeout)

    def _is_current(self, settings: StreamSettings) -> bool:
        """Return true if the source and the output of settings are those that are wanted now."""
        return not _reopens(settings, self._settings)

    def _send(self, source: FrameSource, output: VideoOutput, opened: StreamSettings) -> None:
        """Send the frames of a source until it ends, or until another one is wanted."""
        due = 0.0
        encoded = opened
        for frame in self._frames(source):
            if self._ending or not self._is_current(opened):
                return
            settings = self._settings
            if settings.bitrate != encoded.bitrate or settings.min_bitrate != encoded.min_bitrate:
                output.limit(settings.min_bitrate, settings.bitrate)
            encoded = settings
            now, period = frame.stamp / 1e9, output.divisor / settings.rate
            # A frame may be a quarter of a period early; a gap does not make the next frames come faster.
            if now < due - period / 4 and due - now <= 2 * period:  # it is later still if the clock has jumped back
                continue
            due = max(min(due, now) + period, now + period / 2)
            output.put(self._prepare(frame, settings), frame.stamp)
            self._tell(output, settings)

    def _frames(self, source: FrameSource) -> Iterator[Frame]:
        """Yield the newest frames of a source; a recording is played in real time."""
        if source.live:
            yield from source
            return
        playing = play(source, loop=self._loop, clock=self._clock)
        # A file that is read too slowly is played slowly, and its images are as new as those of a camera.
        shown = (replace(frame, stamp=self._clock.now()) for frame in playing)
        for _, frame in newest([shown]):
            yield frame

    def _tell(self, output: VideoOutput, settings: StreamSettings) -> None:
        refusal, now = output.refusal(), time.monotonic()
        if refusal and now - self._said >= _SAID_S:
            self._said = now
            self._say(
                f"{settings.name}: cannot send to {settings.host}:{settings.port}: {refusal}; check the address and "
                "the network"
            )


def _end(source: FrameSource | None) -> None:
    """End the iteration of a live source, which may be waiting; that of a recording looks for the end itself."""
    if source is not None and source.live:
        source.__exit__(None, None, None)


def _reopens(before: StreamSettings, after: StreamSettings) -> bool:
    return any(getattr(before, name) != getattr(after, name) for name in _REOPENING)
