"""Implementation of ``roverlink objects render``, ``train`` and ``measure``."""

from __future__ import annotations

import roverkit.vision  # noqa: F401  # first: it explains how to install numpy and OpenCV

# isort: split

import argparse
import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from statistics import mean

from roverkit.objects.chosen_detector import open_detector
from roverkit.objects.detected_objects import Box, ObjectDetection
from roverkit.objects.detector import ObjectDetector
from roverkit.objects.metrics import average_precisions
from roverkit.objects.scenes import CLASSES, scenes
from roverkit.objects.training.network import MULTIPLE
from roverkit.objects.yolo_folder import Label, LabelledImage, read_folder, write_folder
from roverkit.vision.markers.detection import Image
from roverlink.console import counted, print_note
from roverlink.progress import progress
from roverlink.runtime.core.errors import SetupError

_VAL_EVERY = 8
_LEAST = 0.01
"""Least score of a detection in a measurement, so that the precision is known at large recalls, too."""


def render(folder: Path, images: int, seed: int) -> None:
    """Write a folder with rendered images. Raises `SetupError` if it cannot be written, or has files."""

    def rendered() -> Iterator[tuple[str, Image, list[Label]]]:
        with progress(str(folder)) as report:
            for number, scene in enumerate(scenes(seed, images), 1):
                labels = [(CLASSES.index(truth.class_name), truth.box) for truth in scene.objects]
                yield "val" if number % _VAL_EVERY == 0 else "train", scene.image, labels
                report(number, images)

    if images < _VAL_EVERY:
        raise SetupError(f"--images is {images}; at least {_VAL_EVERY} are needed, so that one is for the measurement")
    write_folder(folder, CLASSES, rendered())
    print_note(f"{folder}: {counted(images, 'image')}; train with `roverlink objects train {folder}`")


def train(arguments: argparse.Namespace) -> None:
    """Train a network, and print its average precisions. Raises `SetupError` for bad images, or a taken name."""
    if any(side % MULTIPLE for side in arguments.size):
        width, height = arguments.size
        raise SetupError(f"--size is {width}x{height}; width and height must be multiples of {MULTIPLE}")
    data = read_folder(arguments.folder)
    for labelled in (*data.train, *data.val):  # a mistake in a label is told before the training, and not in the middle
        labelled.check()
    from roverkit.objects.training.learning import learn  # only here: `measure` needs no jax
    from roverkit.objects.training.onnx_file import check_replaceable, write_model

    check_replaceable(arguments.out)
    with progress("training") as report:
        learnt = learn(data.train, len(data.names), arguments.size, arguments.epochs, abs(arguments.seed), report)
    description = (
        f"trained with {counted(len(data.train), 'image')} in {arguments.epochs} epochs, seed {arguments.seed}"
    )
    write_model(arguments.out, learnt.weights, learnt.statistics, data.names, arguments.size, description)
    print_note(f"wrote {arguments.out}")
    _print(_measured(ObjectDetector(arguments.out, score=_LEAST), data.val, data.names), data.val, arguments)


def measure(arguments: argparse.Namespace) -> None:
    """Print the average precisions of a detector. Raises `SetupError` if the classes of the images are others."""
    data = read_folder(arguments.folder)
    detector, _ = open_detector(arguments, _LEAST)
    if detector.class_names and not set(data.names) & set(detector.class_names):
        raise SetupError(
            f"{arguments.folder}: the classes are {', '.join(data.names)}, and those of {detector.name} are "
            f"{', '.join(detector.class_names)}; give both the same names"
        )
    _print(_measured(detector, data.val, data.names), data.val, arguments)


def _measured(detector: ObjectDetector, images: Sequence[LabelledImage], names: Sequence[str]) -> Mapping[str, float]:
    """Return the average precision of each class that the images show."""

    def results() -> Iterator[tuple[list[ObjectDetection], list[tuple[str, Box]]]]:
        with progress(f"measuring {detector.name}") as report:
            for number, labelled in enumerate(images, 1):
                image, labels = labelled.read()
                yield detector.detect(image), [(names[index], box) for index, box in labels]
                report(number, len(images))

    return average_precisions(results())


def _print(precisions: Mapping[str, float], images: Sequence[LabelledImage], arguments: argparse.Namespace) -> None:
    whole = mean(precisions.values()) if precisions else 0.0
    if arguments.json:
        rounded = {name: round(value, 4) for name, value in precisions.items()}
        print(json.dumps({"images": len(images), "mAP50": round(whole, 4), "AP50": rounded}))
        return
    width = max(map(len, (*precisions, "mAP50")))
    for name, value in precisions.items():
        print(f"{name:{width}}  {value:.3f}")
    print(f"{'mAP50':{width}}  {whole:.3f}  ({counted(len(images), 'image')})")
