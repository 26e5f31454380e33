"""Detector that the options of a command select."""

from __future__ import annotations

import argparse

from roverkit.objects.detector import SCORE, ObjectDetector
from roverkit.objects.object_types import ClassesFile, read_classes
from roverkit.objects.shipped_model import PATH


def open_detector(arguments: argparse.Namespace, score: float | None = None) -> tuple[ObjectDetector, ClassesFile]:
    """Open the detector of the options of `add_model`; return it with the content of the file of classes.

    Raises `SetupError` if one of the files cannot be used.
    """
    classes = read_classes(arguments.classes) if arguments.classes else ClassesFile()
    least = SCORE if score is None else score
    return ObjectDetector(arguments.model or PATH, arguments.layout, classes.names, least), classes
