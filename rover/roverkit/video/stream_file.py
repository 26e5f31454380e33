"""Files of received video: the encoded images go into them as they are."""

from __future__ import annotations

import io
import os
from fractions import Fraction
from pathlib import Path
from typing import Any

from roverkit.video.av_library import av
from roverkit.video.h264 import NalType, byte_stream, nal_type
from roverkit.video.rtp import CLOCK_HZ
from roverkit.video.rtp_receiver import ReceivedUnit
from roverlink.runtime.core.errors import SetupError

SUFFIXES = (".mkv", ".mp4")
"""Suffixes of the formats: Matroska and MP4."""
_LARGEST_STEP = 10 * CLOCK_HZ  # a longer pause becomes a short one
_STEP = CLOCK_HZ // 30
# A file of fragments can be read up to its last one, also if the program was killed.
_OPTIONS = {".mp4": {"movflags": "frag_keyframe+empty_moov+default_base_moof"}, ".mkv": {"cluster_time_limit": "1000"}}


class StreamFiles:
    """Files of one stream. A context manager that completes the last one.

    The first file begins with a key frame. If the sender is started again or changes the size, another file begins,
    because a file has one size. A file that is there already is never replaced.
    """

    def __init__(self, folder: Path, name: str, suffix: str) -> None:
        """Save to `NAME.mkv`, `NAME-2.mkv` and so on. Raises `SetupError` if the folder cannot be made."""
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise SetupError(f"{folder}: cannot make the folder: {error.strerror}") from error
        if not os.access(folder, os.W_OK):
            raise SetupError(f"{folder}: the folder cannot be written")
        self._folder, self._name, self._suffix = folder, name, suffix
        self._container: Any = None
        self._stream: Any = None
        self._parameters: list[bytes] = []
        self._offset = self._last = 0

    def add(self, unit: ReceivedUnit) -> None:
        """Append an encoded image. Raises `SetupError` if it cannot be written."""
        parameters = [nal for nal in unit.nals if nal_type(nal) in (NalType.SPS, NalType.PPS)]
        begins = unit.key and unit.intact and bool(parameters)
        try:
            if unit.restarted or (begins and parameters != self._parameters and self._has_other_size(unit)):
                self._close()
            if begins:
                self._parameters = parameters
            if self._container is None:
                if not begins:
                    return
                self._open(unit)
            if not 0 <= unit.timestamp + self._offset - self._last <= _LARGEST_STEP:
                self._offset = self._last + _STEP - unit.timestamp
            self._last = max(unit.timestamp + self._offset, self._last + 1)
            packet = av.Packet(byte_stream(unit.nals))
            packet.stream, packet.time_base = self._stream, Fraction(1, CLOCK_HZ)
            packet.pts = packet.dts = self._last
            packet.is_keyframe = unit.key
            self._container.mux(packet)
        except (av.FFmpegError, OSError) as error:
            raise SetupError(f"{self._folder}: cannot write the video: {error}") from error

    def __enter__(self) -> StreamFiles:
        return self

    def __exit__(self, *_: object) -> None:
        self._close()

    def _has_other_size(self, unit: ReceivedUnit) -> bool:
        """Return true if the images of the file have another size. Encoders change other parameters, too."""
        if self._container is None:
            return False
        with _opened(unit) as opened:
            new, old = opened.streams.video[0].codec_context, self._stream.codec_context
            return bool((new.width, new.height) != (old.width, old.height))

    def _open(self, unit: ReceivedUnit) -> None:
        number, path = 1, self._folder / f"{self._name}{self._suffix}"
        while path.exists():
            number += 1
            path = self._folder / f"{self._name}-{number}{self._suffix}"
        # FFmpeg reads the size and the codec's data from the first image.
        with _opened(unit) as first:
            self._container = av.open(str(path), "w", options=_OPTIONS[self._suffix])
            self._stream = self._container.add_stream_from_template(first.streams.video[0])
        self._stream.time_base = Fraction(1, CLOCK_HZ)
        self._offset, self._last = -unit.timestamp, -1

    def _close(self) -> None:
        if self._container is not None:
            self._container.close()
            self._container = None


def _opened(unit: ReceivedUnit) -> Any:
    """Return a key frame as an open container of FFmpeg."""
    return av.open(io.BytesIO(byte_stream(unit.nals)), format="h264")
