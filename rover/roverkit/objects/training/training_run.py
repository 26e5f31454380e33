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
from roverkit.objects.yolo_folder import Label, LabelledImage, YoloFolder, read_folder, write_folder
from roverkit.vision.markers.detection import Image
from roverlink.console import print_note
from roverlink.numerals import counted
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
    """Train a network, and print its average precisions. Raises `SetupError` for bad images, or a taken name.

    Ctrl-C ends the training: the result is that of the epochs that are complete.
    """
    if any(side % MULTIPLE for side in arguments.size):
        width, height = arguments.size
        raise SetupError(f"--size is {width}x{height}; width and height must be multiples of {MULTIPLE}")
    data = _folder(arguments.folder)
    # Only here: `measure` needs no jax.
    from roverkit.objects.training.checkpoint import Plan, checkpoint_of, read_checkpoint, write_checkpoint
    from roverkit.objects.training.learning import learn
    from roverkit.objects.training.onnx_file import check_replaceable, write_model

    check_replaceable(arguments.out)
    seed, checkpoint = abs(arguments.seed), checkpoint_of(arguments.out)
    files = tuple(image.path.name for image in data.train)
    plan = Plan(files, data.names, arguments.size, arguments.epochs, seed)
    begun = read_checkpoint(checkpoint, plan) if arguments.resume else None
    if not begun and checkpoint.exists():
        print_note(f"{checkpoint} is replaced after the first epoch; with --resume, its training goes on")
    newest = [begun] if begun else []
    try:
        with progress("training") as report:
            for now in learn(data.train, len(data.names), arguments.size, arguments.epochs, seed, report, begun):
                newest = [now]
                write_checkpoint(checkpoint, plan, now)
    except KeyboardInterrupt:
        if not newest:
            raise
        print_note(f"stopped after {newest[0].epochs} of {arguments.epochs} epochs; --resume goes on")
    learnt = newest[0]
    images, epochs = counted(len(data.train), "image"), counted(learnt.epochs, "epoch")
    description = f"trained with {images} in {epochs}, seed {arguments.seed}"
    write_model(arguments.out, learnt.weights, learnt.statistics, data.names, arguments.size, description)
    if learnt.epochs == arguments.epochs:
        checkpoint.unlink(missing_ok=True)
    print_note(f"wrote {arguments.out}")
    _print(_measured(ObjectDetector(arguments.out, score=_LEAST), data.val, data.names), data.val, arguments)


def _folder(path: Path) -> YoloFolder:
    """Read a folder, and check all labels: a mistake is told before the training, and not in the middle of it."""
    data = read_folder(path)
    if clipped := sum(labelled.clipped() for labelled in (*data.train, *data.val)):
        print_note(f"{path}: boxes that reach out of the image are clipped ({clipped})")
    return data


def measure(arguments: argparse.Namespace) -> None:
    """Print the average precisions of a detector. Raises `SetupError` if the classes of the images are others."""
    data = _folder(arguments.folder)
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
