"""Output of a stream through a pipeline of GStreamer, which encodes and sends the images.

GStreamer runs as a program of its own, and gets the images on its standard input.
"""

from __future__ import annotations

import contextlib
import re
import shlex
import shutil
import subprocess
from dataclasses import replace
from string import Template
from tempfile import TemporaryFile
from typing import IO, cast

from roverkit.video.stream_settings import StreamSettings
from roverkit.video.video_output import Sent
from roverkit.vision.frames.frame import size_of
from roverkit.vision.markers.detection import Image, to_colour
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.net.hosts import SocketAddress

PIPELINES = {
    "legacy": "videoconvert ! video/x-raw,format=I420 ! x264enc tune=zerolatency speed-preset=superfast ! "
    "rtph264pay pt=96 ! udpsink host=$host port=$port",
}
"""Pipelines by their names.

`legacy` is that of the rover's earlier script. It has a key frame only every 250 images.
"""
_PROGRAM, _INSPECT = "gst-launch-1.0", "gst-inspect-1.0"
_ELEMENT = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")
_INSTALL = (
    "apt-get install gstreamer1.0-tools gstreamer1.0-plugins-base gstreamer1.0-plugins-good gstreamer1.0-plugins-ugly"
)
_END_S = 3.0


class GStreamerOutput:
    """Output through GStreamer. A pipeline reports nothing, so the bitrate and the rate stay as they are."""

    divisor = 1

    def __init__(self, settings: StreamSettings, address: SocketAddress) -> None:
        """Prepare the pipeline.

        Raises `SetupError` if GStreamer is not installed, or for an unknown element or placeholder.
        """
        for program in (_PROGRAM, _INSPECT):
            if shutil.which(program) is None:
                raise SetupError(f"the pipeline needs GStreamer, and {program} is not installed; run `{_INSTALL}`")
        self.sent = Sent()
        self._settings, self._address = settings, address
        self._process: subprocess.Popen[bytes] | None = None
        self._size = (0, 0)
        self._check_elements(self._words((16, 16)))

    def put(self, image: Image, stamp: int) -> None:  # noqa: ARG002  # the pipeline has its own time
        """Give an image to the pipeline. Raises `SetupError` with GStreamer's reason if the pipeline has ended."""
        if self._process is None or size_of(image) != self._size:
            self._start(size_of(image))
        process = cast("subprocess.Popen[bytes]", self._process)
        rest = memoryview(to_colour(image).tobytes())
        try:
            while rest:
                rest = rest[cast("IO[bytes]", process.stdin).write(rest) :]
        except (OSError, ValueError) as error:  # ValueError: `_stop` has closed it
            raise SetupError(f"the pipeline has ended: {self._stop()}") from error
        self.sent.images += 1

    def limit(self, lowest: float, highest: float) -> None:
        """Start the pipeline again with another bitrate in kbit/s."""
        self._settings = replace(self._settings, bitrate=highest, min_bitrate=lowest)
        self._stop()

    def link_measured(self, lost: float, round_trip: float | None) -> None:
        """Ignore what the link measures: only the pipeline knows its encoder."""

    def refusal(self) -> str:
        """Return an empty text: what the network refuses, GStreamer does not tell."""
        return ""

    def __enter__(self) -> GStreamerOutput:
        return self

    def __exit__(self, *_: object) -> None:
        self._stop()

    def _start(self, size: tuple[int, int]) -> None:
        self._stop()
        self._size = size
        self._said = TemporaryFile()  # noqa: SIM115  # `_stop` closes it
        self._process = subprocess.Popen(  # noqa: S603  # the user has chosen the pipeline
            [_PROGRAM, "-q", *self._words(size)],
            stdin=subprocess.PIPE,
            stderr=self._said,
            stdout=subprocess.DEVNULL,
            bufsize=0,  # a buffer has a lock, for which `_stop` would wait if the pipeline hangs
            start_new_session=True,  # Ctrl-C ends this program first, and then the pipeline
        )

    def _words(self, size: tuple[int, int]) -> list[str]:
        """Return the pipeline with its source, as words for gst-launch."""
        settings = self._settings
        text = PIPELINES.get(settings.pipeline, settings.pipeline)
        values = {
            "host": self._address[0],
            "port": self._address[1],
            "bitrate": round(settings.bitrate),
            "rate": round(settings.rate),
            "width": size[0],
            "height": size[1],
        }
        try:
            whole = Template(text).substitute(values)
        except (KeyError, ValueError) as error:
            known = ", ".join(f"${name}" for name in values)
            raise SetupError(f"the pipeline has a wrong placeholder ({error}); known are {known}") from error
        # The images come when they come; their number a second is only what the encoder reckons with.
        raw = f"rawvideoparse format=bgr width={size[0]} height={size[1]} framerate={round(settings.rate)}/1"
        return shlex.split(f"fdsrc fd=0 ! {raw} ! {whole}")

    @staticmethod
    def _check_elements(words: list[str]) -> None:
        """Raise `SetupError` if GStreamer lacks an element of the pipeline."""
        for before, word in zip(["!", *words], words):
            if before == "!" and _ELEMENT.fullmatch(word):
                known = subprocess.run([_INSPECT, "--exists", word], check=False)  # noqa: S603  # only a name
                if known.returncode:
                    raise SetupError(f"GStreamer has no element {word!r}; check the pipeline, or run `{_INSTALL}`")

    def _stop(self) -> str:
        """End the pipeline, and return the reason that it gives if it has failed."""
        process, self._process = self._process, None
        if process is None:
            return ""
        with contextlib.suppress(OSError):  # it has ended by itself
            cast("IO[bytes]", process.stdin).close()
        try:
            process.wait(_END_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        with self._said:
            self._said.seek(0)
            said = self._said.read().decode(errors="replace")
        found = re.search(r"(?:ERROR|WARNING|erroneous pipeline): ?(.*)", said)
        return found[1].strip() if found else said.strip().partition("\n")[0] or f"exit code {process.returncode}"
