"""Sources of frames that end: video files and folders of images.

The metadata of a file may say how to rotate its images for display. This is ignored, because the camera's parameters
belong to the unrotated image.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from roverkit.vision.frames.frame import Frame, rate_of
from roverkit.vision.frames.live import Say
from roverkit.vision.opencv import cv2
from roverlink.runtime.core.errors import SetupError

IMAGES = frozenset((".bmp", ".jpeg", ".jpg", ".png", ".ppm", ".tif", ".tiff", ".webp"))
"""Suffixes of image files."""
VIDEOS = frozenset((".avi", ".m4v", ".mjpeg", ".mjpg", ".mkv", ".mov", ".mp4", ".mpeg", ".mpg", ".ts", ".webm"))
"""Usual suffixes of video files; files with other suffixes are tried as well."""


class _Recorded:
    live = False

    def __init__(self, name: str, rate: float, total: int | None) -> None:
        self.name, self.rate, self.total = name, rate, total


class ImageFiles(_Recorded):
    """Image file, or folder of image files. Numbers in names are sorted by value: `2.png` comes before `10.png`."""

    def __init__(self, path: Path, rate: float, say: Say = lambda _: None, *, upright: bool = False) -> None:
        """List the images; `rate` is the number of images a second.

        `say` is called with a message about each image that cannot be read. With `upright`, images are rotated as their
        metadata says, for which the camera's parameters are not valid. Raises `SetupError` if the folder has no images.
        """
        found = (
            [path]
            if path.is_file()
            else [file for file in path.iterdir() if file.suffix.lower() in IMAGES and file.is_file()]
        )
        if not found:
            raise SetupError(f"{path} contains no images (known: {' '.join(sorted(IMAGES))})")
        self.paths = sorted(found, key=_natural)
        self.unreadable: list[Path] = []
        """Images so far that cannot be read, in the order of `paths`."""
        self._say = say
        self._flags = cv2.IMREAD_COLOR | (0 if upright else cv2.IMREAD_IGNORE_ORIENTATION)
        super().__init__(str(path), rate, len(found))

    def __iter__(self) -> Iterator[Frame]:
        """Yield the images as frames; the number of a frame is its index in `paths`.

        An image that cannot be read is skipped, and named once. Raises `SetupError` if no image can be read.
        """
        for number, path in enumerate(self.paths):
            image = cv2.imread(str(path), self._flags)
            if image is None:
                self._skip(path)
                continue
            yield Frame(image, round(number * 1e9 / self.rate), number)

    def _skip(self, path: Path) -> None:
        if path not in self.unreadable:
            self.unreadable.append(path)
            if len(self.unreadable) == len(self.paths):
                which = "the file" if len(self.paths) == 1 else f"any of its {len(self.paths)} files"
                raise SetupError(f"{self.name}: cannot read {which} as an image")
            self._say(f"{path}: cannot read the file as an image; it is skipped")

    def __enter__(self) -> ImageFiles:
        return self

    def __exit__(self, *_: object) -> None:
        pass


class VideoFile(_Recorded):
    """Video file as a source of frames."""

    def __init__(self, path: Path) -> None:
        """Open the file. Raises `SetupError` if it is not a video."""
        self._capture = cv2.VideoCapture(str(path), cv2.CAP_FFMPEG)
        if not self._capture.isOpened():
            raise SetupError(f"{path}: cannot open the file as a video")
        # OpenCV would else rotate frames by the file's metadata.
        self._capture.set(cv2.CAP_PROP_ORIENTATION_AUTO, 0)
        total = max(int(self._capture.get(cv2.CAP_PROP_FRAME_COUNT)), 0) or None
        super().__init__(str(path), rate_of(self._capture), total)

    def __iter__(self) -> Iterator[Frame]:
        """Yield the frames, beginning with the first. Raises `SetupError` if the file has no frames."""
        self._capture.set(cv2.CAP_PROP_POS_FRAMES, 0)
        number = 0
        while True:
            there, image = self._capture.read()
            if not there:
                break
            yield Frame(image, round(self._capture.get(cv2.CAP_PROP_POS_MSEC) * 1e6), number)
            number += 1
        if not number:
            raise SetupError(f"{self.name} has no frames")

    def __enter__(self) -> VideoFile:
        return self

    def __exit__(self, *_: object) -> None:
        self._capture.release()


def _natural(path: Path) -> list[tuple[str, int]]:
    """Return a key for sorting paths, by which `2.png` comes before `10.png`."""
    return [(text, int(digits or 0)) for text, digits in re.findall(r"(\D*)(\d*)", path.name)]
