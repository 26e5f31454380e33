"""Writes images as a video file."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from roverlink.runtime.core.errors import SetupError
from roverlink.vision.frames.frame import size_of
from roverlink.vision.markers.detection import Image
from roverlink.vision.opencv import cv2

CODECS = {".mp4": "mp4v", ".avi": "MJPG"}
"""What a film may end with, and OpenCV's code for how it is packed: both are in its wheels."""
LONGEST_STILL_S = 2.0
"""A longer time without an image is cut out."""


class Film:
    """A video file of constant rate. A context manager: the file is there, whole, when it is left.

    Images come when they were taken: where one is late the one before stands still, where two come at once one is left
    out.
    """

    def __init__(self, path: Path, rate: float) -> None:
        """`rate` is in images a second. Raises `SetupError` for a file that cannot be written."""
        if path.suffix.lower() not in CODECS:
            raise SetupError(f"{path}: a film ends with {' or '.join(CODECS)}")
        if not path.resolve().parent.is_dir():
            raise SetupError(f"{path}: there is no such folder")
        self._path, self._rate = path, rate
        self._part = path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
        self._writer: Any = None
        self._size = (0, 0)
        self._stamp = self._start = self._written = 0

    def add(self, image: Image, stamp: int) -> None:
        """Go on with an image (H, W, 3), taken at `stamp` in nanoseconds.

        Raises `SetupError` where nothing can be written, or where the image has not the size of the first.
        """
        if self._writer is None:
            self._open(image, stamp)
        if size_of(image) != self._size:
            raise SetupError(f"{self._path}: a film cannot change from {self._size} to {size_of(image)} pixels")
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
            raise SetupError(f"{self._path}: cannot be written as a film of {self._rate:g} images a second")
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
