"""Implementation of ``roverlink objects detect``: objects in single photographs."""

from __future__ import annotations

import roverkit.vision  # noqa: F401  # first: it explains how to install numpy and OpenCV

# isort: split

import argparse
import json
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from roverkit.objects.chosen_detector import open_detector
from roverkit.objects.detected_objects import ObjectDetection, as_json
from roverkit.vision.frames import RATE, ImageFiles
from roverkit.vision.images.object_drawing import draw_detections
from roverkit.vision.markers.detection import Image
from roverkit.vision.opencv import cv2
from roverlink.console import print_note
from roverlink.numerals import counted
from roverlink.progress import progress
from roverlink.runtime.core.errors import SetupError


def detect_objects(arguments: argparse.Namespace) -> None:
    """Print the objects of each image. Raises `SetupError` if no image can be read, or a file cannot be written."""
    if not arguments.images.exists():
        raise SetupError(f"{arguments.images}: there is no such image or folder")
    images = ImageFiles(arguments.images, RATE, print_note, upright=True)
    detector, _ = open_detector(arguments, arguments.score)
    print_note(f"{detector.name}: layout {detector.layout}, run by {detector.provider}")
    if arguments.save:
        _make_empty(arguments.save)
    found: Counter[str] = Counter()
    searched = 0
    with progress(images.name) as report:
        for frame in images:
            searched += 1
            path, objects = images.paths[frame.number], detector.detect(frame.image)
            found.update(detected.class_name for detected in objects)
            _print(path, objects, as_object=arguments.json)
            if arguments.save:
                _write(arguments.save / path.name, draw_detections(frame.image, objects))
            report(frame.number + 1, len(images.paths))
    classes = ", ".join(f"{number} {name}" for name, number in sorted(found.items())) or "none"
    print_note(f"{counted(searched, 'image')} with {counted(found.total(), 'object')}: {classes}")


def _print(path: Path, objects: Sequence[ObjectDetection], *, as_object: bool) -> None:
    if as_object:
        print(json.dumps({"image": str(path), "objects": [as_json(detected) for detected in objects]}), flush=True)
        return
    for detected in objects:
        box = detected.box
        place = f"{box.x:.0f} {box.y:.0f} {box.width:.0f} {box.height:.0f}"
        print(f"{path}: {detected.class_name} {detected.confidence:.2f} at {place}", flush=True)
    if not objects:
        print(f"{path}: no object", flush=True)


def _make_empty(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if any(folder.iterdir()):
            raise SetupError(f"{folder} is not empty; name another folder")
    except OSError as error:
        raise SetupError(f"{folder}: cannot make the folder: {error.strerror}") from error


def _write(path: Path, image: Image) -> None:
    try:
        written = cv2.imwrite(str(path), image)
    except cv2.error as error:
        raise SetupError(f"{path}: cannot write the image: {error.err}") from error
    if not written:
        raise SetupError(f"{path}: cannot write the image; is the disk full?")
