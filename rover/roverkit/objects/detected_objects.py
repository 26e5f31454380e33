"""Objects that a detector has found in an image, and that a tracker follows from image to image."""

from __future__ import annotations

from dataclasses import dataclass


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
    """Number of the object, from 1; no other object of the run has it."""
    box: Box
    """Box as detected in this frame."""
    class_name: str
    """Class with the largest sum of confidences over all frames."""
    confidence: float
    """Smoothed confidence."""
