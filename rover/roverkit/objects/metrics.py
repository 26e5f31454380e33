"""Quality of detectors and trackers, measured with images whose objects are known."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence

import numpy as np

from roverkit.objects.detected_objects import Box, ObjectDetection
from roverkit.vision.camera.camera_model import Floats

_OVERLAP = 0.5
"""Intersection over union from which a box counts as found."""
_POINTS = 101


def overlap(first: Box, second: Box) -> float:
    """Return the intersection over union of two boxes."""
    width = min(first.x + first.width, second.x + second.width) - max(first.x, second.x)
    height = min(first.y + first.height, second.y + second.height) - max(first.y, second.y)
    both = max(width, 0.0) * max(height, 0.0)
    return both / (first.width * first.height + second.width * second.height - both) if both else 0.0


def average_precisions(
    images: Iterable[tuple[Sequence[ObjectDetection], Sequence[tuple[str, Box]]]],
) -> dict[str, float]:
    """Return the average precision (AP50) of each class that the truth has; their mean is mAP50.

    Each image has what was detected, with all scores, and the truth. The precision is interpolated at 101 recalls, as
    COCO's evaluation does (Lin et al., ECCV 2014); an object counts as found once.
    """
    scored: dict[str, list[tuple[float, bool]]] = defaultdict(list)
    wanted: dict[str, int] = defaultdict(int)
    for detections, truth in images:
        for name, _ in truth:
            wanted[name] += 1
        free = list(truth)
        for detection in sorted(detections, key=lambda detection: -detection.confidence):
            fits = [
                (overlap(detection.box, box), index)
                for index, (name, box) in enumerate(free)
                if name == detection.class_name
            ]
            best, index = max(fits, default=(0.0, 0))
            scored[detection.class_name].append((detection.confidence, best >= _OVERLAP))
            if best >= _OVERLAP:
                del free[index]
    return {name: _average_precision(scored[name], count) for name, count in sorted(wanted.items())}


def _average_precision(scored: Sequence[tuple[float, bool]], wanted: int) -> float:
    hits = np.array([hit for _, hit in sorted(scored, key=lambda entry: -entry[0])], float)
    found = np.cumsum(hits)
    precision: Floats = found / np.arange(1, len(hits) + 1)
    # The best precision at this recall or a larger one.
    best = np.append(np.maximum.accumulate(precision[::-1])[::-1], 0.0)
    return float(best[np.searchsorted(found / wanted, np.linspace(0, 1, _POINTS) - 1e-12)].mean())
