"""Detection of objects in images by a neural network in an ONNX file."""

from __future__ import annotations

import ast
import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from roverkit.objects.detected_objects import Box, ObjectDetection
from roverkit.objects.layouts import LAYOUTS, Candidates, Layout, Outputs, Signature, candidates, without_grids
from roverkit.objects.plausibility import objection
from roverkit.objects.runtime_session import Session
from roverkit.vision.markers.detection import Image, to_colour
from roverkit.vision.opencv import cv2
from roverlink.numerals import counted
from roverlink.runtime.core.errors import SetupError, nearest

SCORE = 0.25
"""Default of the least score of a detection."""
AUTHOR = "roverlink"
"""Value of `author` in the metadata of networks of ``roverlink objects train``."""
_CERTAIN, _OWN_CERTAIN = 0.7, 0.5
"""Confidence from which a detection is certain: of other networks, and of those that roverlink has trained.

Scores of the latter are smaller: in a rendered film, the IDF1 of the shipped model is 0.988 with 0.5, 0.916 with 0.7.
"""
_OVERLAP = 0.45
"""Intersection over union from which two boxes of a class show the same object; the default of YOLOv5 and YOLOX."""
_MOST = 300
"""Largest number of detections in an image: those with the best scores."""
_SIZE = 640
"""Width and height of an input whose size the file leaves open, without metadata: the usual one for training."""
_SMALLEST, _LARGEST = 32, 4096


class ObjectDetector:
    """Detector of objects."""

    def __init__(
        self, path: Path, layout: str | None = None, names: Sequence[str] | None = None, score: float = SCORE
    ) -> None:
        """Open a model. `layout` is one of `LAYOUTS`; without it, it is recognized from the model.

        `names` are those of the classes; without them, they are taken from the model's metadata. Detections with a
        score below `score` are left out. Raises `SetupError` if the file cannot be used, if its layout is unknown, or
        if its scores or boxes for a grey image are impossible in this layout.
        """
        if layout is not None and layout not in LAYOUTS:
            raise SetupError(f"unknown layout {layout!r}; {nearest(layout, LAYOUTS)}")
        self._path, self._session, self._score = path, Session(path), score
        self.name = path.name
        """Name for messages."""
        self.provider = self._session.provider
        """Execution provider of ONNX Runtime that runs the model, such as ``CUDAExecutionProvider``."""
        self.certain = _OWN_CERTAIN if self._session.metadata.get("author") == AUTHOR else _CERTAIN
        """Confidence from which a detection is certain, so that a tracker can begin with it."""
        self._size, extra = self._inputs()
        # RT-DETR scales its boxes by the size of the image; here, that of its input.
        self._extra = [np.array([self._size], np.int64)] if extra else []
        known = list(names) if names is not None else self._names()
        head = self._session.metadata.get("head", "")
        self._signature = Signature(
            self._size, self._grey_outputs(), len(known) or None, self._states_suppression(), head
        )
        self._layout = self._recognized(self._signature, layout)
        self.layout = self._layout.name
        """Name of the layout."""
        self.class_names: tuple[str, ...] = tuple(known)
        """Names of the classes; empty if neither the caller nor the model names them."""

    def detect(self, image: Image) -> list[ObjectDetection]:
        """Return the objects in a grey or BGR image, the surest one first; their boxes are clipped to the image.

        Raises `SetupError` if the model fails.
        """
        blob, placement = self._layout.preprocessing.prepare(to_colour(image), self._size)
        outputs = without_grids(self._session.run([blob, *self._extra]))
        with np.errstate(over="ignore", invalid="ignore"):  # a network may compute NaN, which gives no object
            found = self._layout.decode(outputs, self._signature)
            lengths = found.boxes[:, 2:] - found.boxes[:, :2]
            good = (found.scores >= self._score) & (lengths > 0).all(axis=1)  # false for NaN, too
        good &= (found.classes >= 0) & (found.classes < (len(self.class_names) or np.inf))
        best = self._best(Candidates(found.boxes[good].astype(float), found.scores[good], found.classes[good]))
        boxes = placement.to_image(best.boxes)
        boxes[:, 2:] -= boxes[:, :2]
        return [
            ObjectDetection(Box(*box), self._class_name(index), score)
            for box, score, index in zip(boxes.tolist(), best.scores.tolist(), best.classes.tolist(), strict=True)
            if min(box[2:]) > 0
        ]

    def _best(self, found: Candidates) -> Candidates:
        """Return the objects with the best scores: of boxes that overlap, the best one of each class.

        The boxes are not clipped to the image yet, because the networks' own programs compare whole boxes.
        """
        if self._layout.overlapping and len(found.boxes):
            sizes = np.hstack([found.boxes[:, :2], found.boxes[:, 2:] - found.boxes[:, :2]])
            kept = np.ravel(
                cv2.dnn.NMSBoxesBatched(
                    sizes, found.scores.astype(np.float32), found.classes.astype(np.int32), 0.0, _OVERLAP
                )
            ).astype(np.intp)
        else:
            kept = np.arange(len(found.boxes))
        kept = kept[np.argsort(-found.scores[kept], kind="stable")][:_MOST]
        return Candidates(found.boxes[kept], found.scores[kept], found.classes[kept])

    def _class_name(self, index: int) -> str:
        return self.class_names[index] if self.class_names else str(index)

    def _inputs(self) -> tuple[tuple[int, int], bool]:
        """Return width and height of the image input, and true if there is an input for the size of the image."""
        (name, shape), *others = self._session.inputs.items() or [("", ())]
        rest = [other for other, sides in others if len(sides) != 2]
        if len(others) > 1 or rest or len(shape) != 4 or shape[0] not in (1, None) or shape[1] not in (3, None):
            given = ", ".join(f"{other} {_shown(sides)}" for other, sides in self._session.inputs.items())
            given = given or "none"
            raise SetupError(
                f"{self._path}: the inputs are {given}; a detector has one for an image, (1, 3, height, width)"
            )
        height, width = self._open_size(shape[2:])
        if not (_SMALLEST <= height <= _LARGEST and _SMALLEST <= width <= _LARGEST):
            raise SetupError(
                f"{self._path}: the input {name} has {width}x{height} pixels; {_SMALLEST} to {_LARGEST} are possible"
            )
        return (width, height), bool(others)

    def _open_size(self, sides: Sequence[int | None]) -> tuple[int, int]:
        """Return height and width; what the file leaves open is that of training, if the metadata has it."""
        stated = _literal(self._session.metadata.get("imgsz", ""))
        trained = stated if isinstance(stated, list) else [stated, stated]
        if len(trained) != 2 or any(type(side) is not int for side in trained):  # True is an instance of int
            trained = [_SIZE, _SIZE]
        height, width = (side or size for side, size in zip(sides, trained))
        return height, width

    def _names(self) -> list[str]:
        """Return the names of the classes in the metadata, such as ``{0: 'rock', 1: 'socket'}``; [] without any."""
        names = _literal(self._session.metadata.get("names", ""))
        if isinstance(names, dict) and sorted(map(str, names)) == sorted(map(str, range(len(names)))):
            by_index = {int(index): str(name) for index, name in names.items()}
            return [by_index[index] for index in range(len(by_index))]
        return [str(name) for name in names] if isinstance(names, list) else []

    def _states_suppression(self) -> bool:
        """Return true if the metadata of Ultralytics says that the outputs have no overlapping boxes."""
        arguments = _literal(self._session.metadata.get("args", ""))
        inside = isinstance(arguments, dict) and arguments.get("nms") is True
        return inside or self._session.metadata.get("end2end") == "True"

    def _grey_outputs(self) -> Outputs:
        """Return the outputs for a grey image: the file may leave their shapes open, and does not say their meaning."""
        task = self._session.metadata.get("task", "detect")
        if task != "detect":
            raise SetupError(f"{self._path}: the model is for the task {task!r}; export one for 'detect'")
        width, height = self._size
        blank = np.full((1, 3, height, width), 0.5, np.float32)
        return without_grids(self._session.run([blank, *self._extra]))

    def _recognized(self, signature: Signature, layout: str | None) -> Layout:
        with np.errstate(all="ignore"):  # another layout's numbers
            objections = {
                candidate: objection(candidate.decode(signature.outputs, signature), signature.size)
                for candidate in candidates(signature, layout)
            }
        found = [candidate for candidate, reason in objections.items() if not reason]
        if len(found) == 1:
            return found[0]
        outputs = ", ".join(f"{name} {_shown(shape)}" for name, shape in signature.shapes.items())
        classes = f" and {counted(signature.classes, 'class')}" if signature.classes else ""
        start = f"{self._path}: the outputs are {outputs}{classes};"
        if found:
            names = " or ".join(dict.fromkeys(candidate.name for candidate in found))
            raise SetupError(f"{start} this may be {names}; choose with --layout")
        if objections:
            reasons = "; ".join(f"as {candidate.name}, its {reason}" for candidate, reason in objections.items())
            raise SetupError(
                f"{start} for a grey image, they are impossible: {reasons}; rover/docs/objects.md says how to export "
                "networks"
            )
        if layout:
            raise SetupError(
                f"{start} that does not fit the layout {layout}; leave --layout out, or correct the classes"
            )
        raise SetupError(
            f"{start} no known layout has them; rover/docs/objects.md lists the layouts and how to export them"
        )


def _literal(text: str) -> object:
    """Return the value of a text of metadata, which is Python or JSON; None if it is neither."""
    for parse in (ast.literal_eval, json.loads):
        try:
            return parse(text)
        except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError):
            continue
    return None


def _shown(shape: Sequence[int | None]) -> str:
    return f"({', '.join('?' if side is None else str(side) for side in shape)})"
