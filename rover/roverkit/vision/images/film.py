"""Writing of images to a video file."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from roverkit.vision.frames.frame import size_of
from roverkit.vision.markers.detection import Image
from roverkit.vision.opencv import cv2
from roverlink.numerals import counted
from roverlink.runtime.core.errors import SetupError

CODECS = {".mp4": "mp4v", ".avi": "MJPG"}
"""Codec of OpenCV for each suffix of a video file; the pip packages of OpenCV contain both codecs."""
LONGEST_STILL_S = 2.0
"""Longest time in seconds for which the video repeats an image; the rest of a longer gap is cut out."""


class Film:
    """Video file that is written, with a constant frame rate. A context manager: the complete file appears on exit.

    The stamp of an image decides at which time of the video it is shown. If an image comes late, the previous one is
    repeated. If two images belong to the same frame of the video, one is left out.
    """

    def __init__(self, path: Path, rate: float, source: str = "") -> None:
        """Check the path; `rate` is the number of images a second, `source` names the source of the images.

        Raises `SetupError` if the file cannot be written, or if it is the source.
        """
        if path.exists() and Path(source).exists() and path.samefile(Path(source)):
            raise SetupError(f"{path} is the source of the images; give --save another name")
        if path.suffix.lower() not in CODECS:
            raise SetupError(f"{path}: unknown video format; the name must end with {' or '.join(CODECS)}")
        if not path.resolve().parent.is_dir():
            raise SetupError(f"{path}: the folder does not exist")
        self._path, self._rate = path, rate
        # The suffix stays at the end, because OpenCV chooses the container by it.
        self._part = path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
        self._writer: Any = None
        self._size = (0, 0)
        self._stamp = self._start = self._written = 0

    def add(self, image: Image, stamp: int) -> None:
        """Add an image (H, W, 3) that was taken at `stamp`, in nanoseconds.

        Raises `SetupError` if writing fails, or if the image and the first image differ in size.
        """
        if self._writer is None:
            self._open(image, stamp)
        if size_of(image) != self._size:
            raise SetupError(
                f"{self._path}: the image size changed from {self._size} to {size_of(image)}; a video has one size"
            )
        # A camera that was lost for an hour must not become an hour of one still image.
        self._start += max(stamp - self._stamp - round(LONGEST_STILL_S * 1e9), 0)
        self._stamp = stamp
        due = round((stamp - self._start) * self._rate / 1e9) + 1
        for _ in range(due - self._written):
            self._writer.write(image)
        self._written = max(due, self._written)

    def _open(self, image: Image, stamp: int) -> None:
        self._size = size_of(image)
        code = cv2.VideoWriter_fourcc(*CODECS[self._path.suffix.lower()])
        self._writer = cv2.VideoWriter(str(self._part), cv2.CAP_FFMPEG, code, self._rate, self._size)
        if not self._writer.isOpened():
            raise SetupError(f"{self._path}: cannot write a video with {counted(self._rate, 'image')} a second")
        self._start = self._stamp = stamp

    def __enter__(self) -> Film:
        return self

    def __exit__(self, *_: object) -> None:
        if self._writer is None:
            return
        self._writer.release()
        if self._written:
            self._part.replace(self._path)
        self._part.unlink(missing_ok=True)
