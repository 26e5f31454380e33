"""Section `objects`: numbers of objects in rendered sequences, and what an image costs beside the network."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Protocol

import numpy as np
from roverkit.objects.detected_objects import ObjectDetection, TrackedObject
from roverkit.objects.detector import ObjectDetector
from roverkit.objects.metrics import overlap
from roverkit.objects.object_rows import DetectedObjectRow
from roverkit.objects.object_tracker import ObjectTracker
from roverkit.objects.scenes import RenderedScene, sequence
from roverkit.objects.shipped_model import PATH
from scipy.optimize import linear_sum_assignment

from bench.result import Group, SectionResult, Table
from generated.registry import REGISTRY
from rover.tests.vision.onnx_models import write

SEED = 11
FRAMES = 90
_PERIOD_NS = 33_333_333
_OVERLAP = 0.5
_MISSED = 0.2

Seen = list[tuple[RenderedScene, list[ObjectDetection]]]


class Tracker(Protocol):
    """What gives the detections of a frame their numbers."""

    def track(self, detections: Iterable[ObjectDetection], stamp: int) -> list[TrackedObject]:
        """Return the objects that are visible in a frame; `stamp` is in nanoseconds."""


class NearestOverlap:
    """What a user would write: a box has the number of the box that it overlaps most in the last frame."""

    def __init__(self) -> None:
        self._last: list[TrackedObject] = []
        self._count = 0

    def track(
        self,
        detections: Iterable[ObjectDetection],
        stamp: int,  # noqa: ARG002  # as `Tracker`
    ) -> list[TrackedObject]:
        """Return the objects that are visible in a frame."""
        free, found = list(self._last), []
        for detection in detections:
            best = max(free, key=lambda other: overlap(other.box, detection.box), default=None)
            if best is None or overlap(best.box, detection.box) < 0.3:
                self._count += 1
                number = self._count
            else:
                free.remove(best)
                number = best.id
            found.append(TrackedObject(number, detection.box, detection.class_name, detection.confidence))
        self._last = found
        return found


CONTESTANTS: Mapping[str, Callable[[], Tracker]] = {
    "roverlink": lambda: ObjectTracker(certain=ObjectDetector(PATH).certain),
    "nearest overlap with the last frame": NearestOverlap,
}


def idf1(seen: Seen, tracker: Tracker) -> float:
    """Return the IDF1 (Ristani et al., ECCV 2016) of the numbers that a tracker gives to the objects of a sequence.

    It is 1 if each true object has one number in all frames in which it is visible, and nothing else has a number.
    """
    together: dict[tuple[int, int], int] = {}
    true_frames: dict[int, int] = {}
    given_frames: dict[int, int] = {}
    for number, (scene, detections) in enumerate(seen):
        objects = tracker.track(detections, number * _PERIOD_NS)
        for item in objects:
            given_frames[item.id] = given_frames.get(item.id, 0) + 1
        for truth in scene.objects:
            true_frames[truth.number] = true_frames.get(truth.number, 0) + 1
            for one in objects:
                if overlap(one.box, truth.box) >= _OVERLAP:
                    pair = truth.number, one.id
                    together[pair] = together.get(pair, 0) + 1
    truths, numbers = sorted(true_frames), sorted(given_frames)
    counts = np.array([[together.get((truth, one), 0) for one in numbers] for truth in truths])
    right = counts[linear_sum_assignment(-counts)].sum() if counts.size else 0
    return float(2 * right / (sum(true_frames.values()) + sum(given_frames.values())))


def sequences(count: int, frames: int = FRAMES) -> Iterator[list[RenderedScene]]:
    """Yield rendered sequences: by turns of panels and of rocks."""
    for number in range(count):
        yield list(sequence(SEED + number, frames, panel=number % 2 == 0))


def detected(scenes: Sequence[RenderedScene], detector: ObjectDetector) -> Seen:
    """Return what the detector finds in each frame."""
    return [(scene, detector.detect(scene.image)) for scene in scenes]


def perfect(scenes: Sequence[RenderedScene], missed: float) -> Seen:
    """Return the true boxes, some of which are left out at random."""
    rng = np.random.default_rng(SEED)
    return [
        (
            scene,
            [ObjectDetection(item.box, item.class_name, 0.9) for item in scene.objects if rng.random() >= missed],
        )
        for scene in scenes
    ]


def measure(count: int, say: Callable[[str], None]) -> SectionResult:
    """Measure `count` sequences, and the cost of an image."""
    detector = ObjectDetector(PATH)
    sources: dict[str, Callable[[list[RenderedScene]], Seen]] = {
        "boxes of the shipped model": lambda scenes: detected(scenes, detector),
        "true boxes": lambda scenes: perfect(scenes, 0.0),
        f"true boxes, {_MISSED:.0%} of them missing": lambda scenes: perfect(scenes, _MISSED),
    }
    found: dict[tuple[str, str], list[float]] = {}
    for number, scenes in enumerate(sequences(count), 1):
        for source, make in sources.items():
            seen = make(scenes)
            for name, contestant in CONTESTANTS.items():
                found.setdefault((source, name), []).append(idf1(seen, contestant()))
        say(f"objects: {number} of {count} sequences")
    groups = [
        Group(
            source,
            [
                (name, f"{statistics.mean(found[source, name]):.3f}", f"{min(found[source, name]):.3f}")
                for name in CONTESTANTS
            ],
        )
        for source in sources
    ]
    quality = Table(
        f"Numbers of objects, {count} sequences of {FRAMES} frames at 30 Hz", ("IDF1", "mean", "least"), groups
    )
    film = next(sequences(1, 60))
    costs = {"the shipped model": cost(film, detector)}
    with TemporaryDirectory() as folder:
        costs["640x640, 80 classes, a network that takes no time"] = cost(
            film, _without_network(Path(folder) / "m.onnx")
        )
    table = Table(
        "One image of 640x480, in ms (median)",
        ("step", "ms"),
        [Group(name, [(step, f"{value:.2f}") for step, value in steps.items()]) for name, steps in costs.items()],
        ["Goal: 3 ms beside the network for an input of 640x640."],
    )
    data = {"idf1": {f"{source}: {name}": values for (source, name), values in found.items()}, "cost_ms": costs}
    return SectionResult([quality, table], (), {"objects": data})


def _without_network(path: Path) -> ObjectDetector:
    """Return a detector of YOLOv8's size that finds 20 objects, each with eight boxes, in every image."""
    rng = np.random.default_rng(SEED)
    table = rng.uniform(0, 0.2, (1, 84, 8400)).astype(np.float32)
    for number in range(160):
        thing, copy = divmod(number, 8)
        table[0, :4, 50 * number] = (30 * thing + 20 + copy / 2, 200, 25, 25)
        table[0, 4 + thing % 5, 50 * number] = 0.6 + 0.03 * copy
    return ObjectDetector(write(path, {"output0": table}, (640, 640)))


def cost(scenes: Sequence[RenderedScene], detector: ObjectDetector) -> dict[str, float]:
    """Return the median time of each step in milliseconds."""
    tracker, row, times = ObjectTracker(), DetectedObjectRow(REGISTRY), dict[str, list[float]]()

    def timed(name: str, begin: float) -> float:
        now = time.perf_counter()
        times.setdefault(name, []).append(1e3 * (now - begin))
        return now

    for number, scene in enumerate(scenes):
        begin = now = time.perf_counter()
        detections = detector.detect(scene.image)
        now = timed("detection", now)
        objects = tracker.track(detections, number * _PERIOD_NS)
        now = timed("tracking", now)
        list(row.messages([(item, 1) for item in objects], (640, 480)))
        timed("messages", now)
        timed("whole", begin)
    return {name: statistics.median(values) for name, values in times.items()}
