"""Objects that a detector has found in an image, and that a tracker follows from image to image."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

_DIGITS = 6  # significant digits of JSON


@dataclass(frozen=True, slots=True)
class Box:
    """Rectangle in an image in pixels; x and y are its upper left corner."""

    x: float
    y: float
    width: float
    height: float


@dataclass(frozen=True, slots=True)
class ObjectDetection:
    """Object that a detector has found in one image."""

    box: Box
    class_name: str
    confidence: float


@dataclass(frozen=True, slots=True)
class TrackedObject:
    """Object that is visible in a frame."""

    id: int
    """Number of the object, above 0; no other object of the run has it."""
    box: Box
    """Box as detected in this frame."""
    class_name: str
    """Class with the largest sum of confidences over all frames."""
    confidence: float
    """Smoothed confidence."""


def as_json(found: ObjectDetection | TrackedObject) -> dict[str, Any]:
    """Return class, confidence and box of an object as JSON values; the box is in pixels."""
    box = {name: rounded(value) for name, value in asdict(found.box).items()}
    return {"class": found.class_name, "confidence": rounded(found.confidence), "box": box}


def rounded(value: float) -> float:
    """Return a number as JSON has it, with six significant digits."""
    return float(f"{value:.{_DIGITS}g}")
