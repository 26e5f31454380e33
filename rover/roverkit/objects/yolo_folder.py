"""Folder with labelled images in YOLO's format.

    data.yaml            names: [rock, socket] or {0: rock, 1: socket}; train: images/train; val: images/val
    images/train/a.jpg
    labels/train/a.txt   one line for each object: class, and x y of the middle, width, height as parts of the image

An image without a file of labels shows no object. `path` in data.yaml is the folder to which the others are relative,
if it exists; exports often have that of another computer.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from roverkit.objects.detected_objects import Box
from roverkit.objects.object_types import class_names
from roverkit.vision.markers.detection import Image
from roverkit.vision.opencv import cv2
from roverkit.vision.yaml_file import Item, read_file
from roverlink.bounded_files import read_text
from roverlink.runtime.core.errors import SetupError

_IMAGES = frozenset((".jpg", ".jpeg", ".png", ".bmp", ".webp"))
_KEYS = ("path", "train", "val", "test", "names", "nc", "download", "roboflow", "kpt_shape", "flip_idx")
"""Keys that exports write; of those after `names`, nothing is needed here."""
_SLACK = 0.001  # part of the image by which rounding may move a box out of it

Label = tuple[int, Box]
"""Index of the class, and the box in pixels."""


@dataclass(frozen=True, slots=True)
class LabelledImage:
    """Image file with its file of labels, which may not exist."""

    path: Path
    labels: Path
    classes: int

    def read(self) -> tuple[Image, list[Label]]:
        """Return the BGR image and its labels. Raises `SetupError`, with file and line, for a mistake in them."""
        image = cv2.imread(str(self.path), cv2.IMREAD_COLOR)
        if image is None:
            raise SetupError(f"{self.path}: cannot read the image; remove it, or write it again")
        return image, self._read_labels((image.shape[1], image.shape[0]))

    def check(self) -> None:
        """Raise `SetupError` if there is a mistake in the labels."""
        self._read_labels((1, 1))

    def _read_labels(self, size: tuple[int, int]) -> list[Label]:
        try:
            lines = read_text(self.labels).splitlines() if self.labels.exists() else []
        except OSError as error:
            raise SetupError(f"{self.labels}: cannot read the labels: {error.strerror}") from error
        return [self._label(line, number, size) for number, line in enumerate(lines, 1) if line.strip()]

    def _label(self, line: str, number: int, size: tuple[int, int]) -> Label:
        where = f"{self.labels}:{number}"
        try:
            index, *rest = (float(word) for word in line.split())
            if len(rest) > 4 and len(rest) % 2 == 0:  # the outline of the object, as for segmentation
                xs, ys = rest[0::2], rest[1::2]
                rest = [(min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2, max(xs) - min(xs), max(ys) - min(ys)]
            x, y, width, height = rest
        except ValueError as error:
            raise SetupError(f"{where}: {line!r} is not 'class x y width height'") from error
        if index != int(index) or not 0 <= index < self.classes:
            raise SetupError(f"{where}: there is no class {index:g}; data.yaml has {self.classes} classes, from 0")
        edges = (x - width / 2, y - height / 2, x + width / 2, y + height / 2)
        inside = all(-_SLACK <= edge <= 1 + _SLACK for edge in edges)  # false for NaN, too
        if not inside or min(width, height) <= 0:
            raise SetupError(f"{where}: {line!r} is no box inside the image; numbers are parts of it, from 0 to 1")
        return int(index), Box(edges[0] * size[0], edges[1] * size[1], width * size[0], height * size[1])


@dataclass(frozen=True, slots=True)
class YoloFolder:
    """Labelled images, for training and for the measurement of what was learnt."""

    names: tuple[str, ...]
    train: tuple[LabelledImage, ...]
    val: tuple[LabelledImage, ...]


def read_folder(folder: Path) -> YoloFolder:
    """Read data.yaml, and find the images that it names. Raises `SetupError` if it is wrong, or names no images."""
    path = folder / "data.yaml"
    entries = read_file(path, "data").known_entries(_KEYS)
    for key in ("names", "train", "val"):
        if key not in entries:
            raise SetupError(f"{path}: the key {key!r} is missing")
    names = class_names(entries["names"])
    base = Path(entries["path"].text or "") if "path" in entries else folder
    base = base if base.is_absolute() and base.is_dir() else folder
    train, val = (_images(entries[key], base, len(names)) for key in ("train", "val"))
    return YoloFolder(names, train, val)


def write_folder(folder: Path, names: Sequence[str], images: Iterable[tuple[str, Image, Sequence[Label]]]) -> None:
    """Write a folder that does not exist or is empty; each image belongs to the part ``train`` or ``val``.

    Raises `SetupError` if the folder has files, or if it cannot be written.
    """
    try:
        if folder.is_dir() and any(folder.iterdir()):
            raise SetupError(f"{folder} is not empty; name another folder")
        for part in ("train", "val"):
            for kind in ("images", "labels"):
                (folder / kind / part).mkdir(parents=True)
        for number, (part, image, labels) in enumerate(images):
            height, width = image.shape[:2]
            stem = f"{number:05}"
            lines = [
                f"{index} {(box.x + box.width / 2) / width:.6f} {(box.y + box.height / 2) / height:.6f} "
                f"{box.width / width:.6f} {box.height / height:.6f}\n"
                for index, box in labels
            ]
            cv2.imwrite(str(folder / "images" / part / f"{stem}.jpg"), image, [cv2.IMWRITE_JPEG_QUALITY, 95])
            (folder / "labels" / part / f"{stem}.txt").write_text("".join(lines), encoding="utf-8")
        # Last: a folder that is not complete has none.
        text = f"train: images/train\nval: images/val\nnames: [{', '.join(names)}]\n"
        (folder / "data.yaml").write_text(text, encoding="utf-8")
    except OSError as error:
        raise SetupError(f"{folder}: cannot write the images: {error.strerror or error}") from error


def _images(item: Item, base: Path, classes: int) -> tuple[LabelledImage, ...]:
    """Return the images of a folder that data.yaml names."""
    given = Path(item.text or "")
    # Exports of Roboflow begin with "../", for a folder of data sets around this one.
    choices = [base / given, base / Path(*[part for part in given.parts if part != ".."])]
    folder = next((choice for choice in choices if choice.is_dir()), None)
    if folder is None:
        raise item.error(f"{item.name}: there is no folder {base / given}")
    found = sorted(path for path in folder.rglob("*") if path.suffix.lower() in _IMAGES)
    if not found:
        raise item.error(f"{item.name}: the folder {folder} has no images")
    return tuple(LabelledImage(path, _labels_of(path), classes) for path in found)


def _labels_of(image: Path) -> Path:
    """Return the file of labels of an image: the last folder ``images`` of its path becomes ``labels``."""
    parts = list(image.parts)
    for index in range(len(parts) - 2, -1, -1):
        if parts[index] == "images":
            parts[index] = "labels"
            break
    return Path(*parts).with_suffix(".txt")
