"""Folder with labelled images in YOLO's format, as Ultralytics, Roboflow, CVAT and Label Studio write it.

    data.yaml            names: [rock, socket] or {0: rock, 1: socket}; train: images/train; val: images/val
    images/train/a.jpg
    labels/train/a.txt   one line for each object: class, and x y of the middle, width, height as parts of the image

`train` and `val` are a folder, a text file with a path in each line, or a list of these. In place of data.yaml, there
may be obj.data with obj.names (CVAT's "YOLO 1.1"), or classes.txt beside images/ and labels/ (Label Studio).

An image without a file of labels shows no object. `path` in data.yaml is the folder to which the others are relative,
if it exists; exports often have that of another computer. Without `val`, every eighth image is for the measurement.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from roverkit.objects.detected_objects import Box
from roverkit.objects.object_types import class_names
from roverkit.vision.frames.recorded import IMAGES
from roverkit.vision.markers.detection import Image
from roverkit.vision.opencv import cv2
from roverkit.vision.yaml_file import read_file
from roverlink.bounded_files import read_text
from roverlink.console import print_note
from roverlink.numerals import counted
from roverlink.runtime.core.errors import SetupError, nearest

_KEYS = ("path", "train", "val", "test", "names", "nc", "download", "roboflow", "kpt_shape", "flip_idx")
"""Keys that exports write; of those after `names`, only `kpt_shape` is needed here."""
_ROUNDING, _OUTSIDE = 0.001, 0.1
"""Parts of the image by which a box may reach out of it: unnoticed, and with a message that it is clipped."""
_VAL_EVERY = 8
"""Without images `val`, each image with this distance is for the measurement."""
Say = Callable[[str], None]
"""Function that is called with a message for the user."""

Label = tuple[int, Box]
"""Index of the class, and the box in pixels."""


@dataclass(frozen=True, slots=True)
class LabelledImage:
    """Image file with its file of labels, which may not exist."""

    path: Path
    labels: Path
    classes: int
    points: bool = False
    """True if each box is followed by points of a skeleton, which are not needed."""

    def read(self) -> tuple[Image, list[Label]]:
        """Return the BGR image and its labels, clipped to the image.

        Raises `SetupError`, with file and line, for a mistake in them.
        """
        image = cv2.imread(str(self.path), cv2.IMREAD_COLOR)
        if image is None:
            raise SetupError(f"{self.path}: cannot read the image; remove it, or write it again")
        size = image.shape[1], image.shape[0]
        return image, [(label, _clipped(box, size)) for label, box in self._read_labels(size)]

    def clipped(self) -> int:
        """Return the number of boxes that reach out of the image. Raises `SetupError` for a mistake in the labels."""
        reaches = (
            max(-box.x, -box.y, box.x + box.width - 1, box.y + box.height - 1) for _, box in self._read_labels((1, 1))
        )
        return sum(reach > _ROUNDING for reach in reaches)

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
            if self.points:
                rest = rest[:4]
            elif len(rest) % 2:  # the number of a track follows, as in CVAT's "Ultralytics YOLO Detection Track"
                rest = rest[:-1]
            if len(rest) > 4:  # the outline of the object, as for segmentation
                xs, ys = rest[0::2], rest[1::2]
                rest = [(min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2, max(xs) - min(xs), max(ys) - min(ys)]
            x, y, width, height = rest
        except ValueError as error:
            raise SetupError(f"{where}: {line!r} is not 'class x y width height'") from error
        if index not in range(self.classes):  # true for NaN, too
            raise SetupError(f"{where}: there is no class {index:g}; there are {self.classes}, from 0")
        edges = (x - width / 2, y - height / 2, x + width / 2, y + height / 2)
        inside = all(-_OUTSIDE <= edge <= 1 + _OUTSIDE for edge in edges)  # false for NaN, too
        if not inside or min(width, height) <= 0 or not (0 <= x <= 1 and 0 <= y <= 1):
            raise SetupError(f"{where}: {line!r} is no box inside the image; numbers are parts of it, from 0 to 1")
        return int(index), Box(edges[0] * size[0], edges[1] * size[1], width * size[0], height * size[1])


def _clipped(box: Box, size: tuple[int, int]) -> Box:
    left, top = max(box.x, 0.0), max(box.y, 0.0)
    return Box(left, top, min(box.x + box.width, size[0]) - left, min(box.y + box.height, size[1]) - top)


@dataclass(frozen=True, slots=True)
class YoloFolder:
    """Labelled images, for training and for the measurement of what was learnt."""

    names: tuple[str, ...]
    train: tuple[LabelledImage, ...]
    val: tuple[LabelledImage, ...]


def read_folder(folder: Path, say: Say = print_note) -> YoloFolder:
    """Find the labelled images of a folder; `say` is called with messages about what is unusual.

    No image is both in `train` and in `val`. Raises `SetupError` if the folder is wrong, or has no images.
    """
    export = _export(folder, say)
    if not export.train:
        raise SetupError(f"{export.file}: there is no image in train")
    measured = {path.resolve() for path in export.val}
    learnt, kept = [path for path in export.train if path.resolve() not in measured], export.val
    if learnt and kept:
        if both := len(export.train) - len(learnt):
            say(f"{export.file}: {counted(both, 'image')} of train are in val, too, and are not learnt")
    else:
        kept = export.train[::_VAL_EVERY]
        learnt = [path for number, path in enumerate(export.train) if number % _VAL_EVERY]
        if not learnt:
            raise SetupError(f"{export.file}: there is one image; training needs some, and others for the measurement")
        say(f"{export.file}: there are no images for val only; {len(kept)} of train are measured, and not learnt")
    train, val = (
        [LabelledImage(path, _labels_of(path), len(export.names), export.points) for path in part]
        for part in (learnt, kept)
    )
    if missing := [image for image in (*train, *val) if not image.labels.exists()]:
        if len(missing) == len(train) + len(val):
            raise SetupError(f"{export.file}: no image has a file of labels, such as {missing[0].labels}")
        say(f"{export.file}: {counted(len(missing), 'image')} without a file of labels count as without objects")
    return YoloFolder(export.names, tuple(train), tuple(val))


@dataclass(frozen=True, slots=True)
class _Export:
    """Content of the file that describes the folder."""

    file: Path
    names: tuple[str, ...]
    train: Sequence[Path]
    val: Sequence[Path]
    points: bool = False


def _export(folder: Path, say: Say) -> _Export:
    file = next((folder / name for name in ("data.yaml", "obj.data", "classes.txt") if (folder / name).exists()), None)
    if file is None:
        raise SetupError(f"{folder}: there is no data.yaml, obj.data or classes.txt; export in the format 'YOLO'")
    try:
        if file.name == "data.yaml":
            return _of_data_yaml(file, say)
        if file.name == "obj.data":
            return _of_obj_data(file)
        return _Export(file, _names(file), _images("images", folder), ())
    except _NoImagesError as error:
        raise SetupError(f"{file}: {error}") from error


def _of_data_yaml(file: Path, say: Say) -> _Export:
    entries = read_file(file, "data").entries()
    for key in [key for key in entries if key not in _KEYS]:
        say(f"{file}: the key {key!r} is unknown, and has no effect; {nearest(str(key), _KEYS)}")
    for key in ("names", "train"):
        if key not in entries:
            raise SetupError(f"{file}: the key {key!r} is missing")
    base = file.parent / (entries["path"].text or "") if "path" in entries else file.parent
    base = base if base.is_dir() else file.parent

    def listed(key: str) -> list[Path]:
        item = entries.get(key)
        if item is None or item.value is None:
            return []
        found = []
        for entry in item.items(f"an entry of {key}") or [item]:
            try:
                found += _images(entry.filled_text("the path of a folder or of a list"), base)
            except _NoImagesError as error:
                hint = "; without val, every eighth image is for the measurement" if key == "val" else ""
                raise entry.error(f"{key}: {error}{hint}") from error
        return list(dict.fromkeys(found))

    return _Export(file, class_names(entries["names"]), listed("train"), listed("val"), "kpt_shape" in entries)


def _of_obj_data(file: Path) -> _Export:
    """Read the file of darknet: lines such as ``train = data/train.txt``."""
    pairs = (line.partition("=") for line in _lines(file))
    entries = {key.strip(): value.strip() for key, _, value in pairs}
    names = _placed(entries.get("names", "obj.names"), file.parent)
    train, val = (_images(entries[key], file.parent) if entries.get(key) else [] for key in ("train", "valid"))
    return _Export(file, _names(names), train, val)


class _NoImagesError(Exception):
    """Raised if a path leads to no images."""


def _images(text: str, base: Path) -> list[Path]:
    """Return the images of a folder, or those of a list. Raises `_NoImagesError` if there are none."""
    place = _placed(text, base)
    if place.is_dir():
        found = sorted(path for path in place.rglob("*") if path.suffix.lower() in IMAGES)
    elif place.exists():
        found = [_placed(line, base) for line in _lines(place)]
        if lost := next((path for path in found if not path.is_file()), None):
            raise _NoImagesError(f"{place} names {lost}, which does not exist; export the images, too")
    else:
        raise _NoImagesError(f"there is no {place}")
    if not found:
        raise _NoImagesError(f"{place} has no images")
    return found


def _placed(text: str, base: Path) -> Path:
    """Return the path that an export means; the stated one if none exists.

    Paths in exports of Roboflow begin with "../", for a folder of data sets around this one, those of CVAT with
    "data/", and others with the folder of another computer.
    """
    given = Path(text.replace("\\", "/"))
    parts = [part for part in given.parts if part != ".."]
    # Of a folder, one name is too little: many are called "images".
    starts = range(len(parts) if given.suffix else max(1, len(parts) - 1))
    choices = (base / choice for choice in (given, *(Path(*parts[start:]) for start in starts)))
    return next((choice for choice in choices if choice.exists()), base / given)


def _names(file: Path) -> tuple[str, ...]:
    names = tuple(_lines(file))
    if not names or len(set(names)) < len(names):
        raise SetupError(f"{file}: the lines are not different names of classes")
    return names


def _lines(file: Path) -> list[str]:
    """Return the lines of a text file that are not empty."""
    try:
        return [line.strip() for line in read_text(file).splitlines() if line.strip()]
    except OSError as error:
        raise SetupError(f"{file}: cannot read the file: {error.strerror}") from error


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


def _labels_of(image: Path) -> Path:
    """Return the file of labels of an image: the last folder ``images`` of its path becomes ``labels``."""
    parts = list(image.parts)
    for index in range(len(parts) - 2, -1, -1):
        if parts[index] == "images":
            parts[index] = "labels"
            break
    return Path(*parts).with_suffix(".txt")
