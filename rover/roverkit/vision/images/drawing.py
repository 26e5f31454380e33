"""Drawing of landmarks (markers and boards) and of the camera's position into an image."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from roverkit.vision.camera.camera_model import CameraParameters, Floats
from roverkit.vision.localization.pose_from_landmarks import FieldPose
from roverkit.vision.markers.detection import Image, to_colour
from roverkit.vision.markers.tracker import LandmarkDetection
from roverkit.vision.opencv import cv2

Colour = tuple[int, int, int]

SEEN: Colour = (80, 220, 60)
"""Colour (BGR) of a landmark's outline."""
REJECTED: Colour = (40, 40, 235)
"""Colour (BGR) of the outline of a landmark that does not fit the others, or that shares its number."""
AXES: tuple[Colour, Colour, Colour] = ((40, 40, 235), (60, 200, 60), (235, 120, 40))
"""Colours (BGR) of the axes: x red, y green, z blue, as in RViz."""
_INK, _PAPER = (255, 255, 255), (30, 30, 30)
_SHIFT = 4  # fractional bits of OpenCV's coordinates: sixteenths of a pixel
_LINE = 720  # image height in pixels for which lines are one pixel wide
_FONT = 0


def draw(
    image: Image, camera: CameraParameters, detections: Sequence[LandmarkDetection], pose: FieldPose | None
) -> Image:
    """Return a copy (H, W, 3) of an image with the outline, axes, name and distance of each landmark drawn into it.

    If `pose` is given, the camera's position on the field is written into the image too.
    """
    drawn = to_colour(image)
    rejected = pose.rejected if pose else ()
    for detection in detections:
        _outline(drawn, detection, REJECTED if detection.shared or detection.id in rejected else SEEN)
        _axes(drawn, camera, detection)
        low = detection.corners.min(axis=0)
        write_label(
            drawn,
            f"{detection.id}: {np.linalg.norm(detection.pose.translation):.2f} m",
            (low[0], low[1] - 4 * line_width(drawn)),
        )
    if pose:
        x, y, z = pose.pose.translation
        text = f"{pose.frame}: x {x:.2f}  y {y:.2f}  z {z:.2f} m, by {len(pose.used)}"
        write_label(drawn, text, (6 * line_width(drawn), drawn.shape[0] - 8 * line_width(drawn)))
    return drawn


def write_above(image: Image, text: str) -> Image:
    """Write a line of text into the upper left corner of an image (H, W, 3), and return the image."""
    write_label(image, text, (0, 0))
    return image


def line_width(image: Image) -> int:
    """Return the width in pixels of thin lines in an image."""
    height: int = image.shape[0]
    return max(1, round(height / _LINE))


def _outline(image: Image, detection: LandmarkDetection, colour: Colour) -> None:
    for corners in detection.corners.reshape(-1, 4, 2):
        cv2.polylines(image, [_fixed(corners)], True, colour, line_width(image) + 1, cv2.LINE_AA, _SHIFT)
        cv2.circle(image, _fixed(corners[0]).tolist(), 3 << _SHIFT, colour, -1, cv2.LINE_AA, _SHIFT)


def _axes(image: Image, camera: CameraParameters, detection: LandmarkDetection) -> None:
    """Draw the axes of a landmark's frame at its origin; their length is half the side of a marker."""
    length = float(np.linalg.norm(detection.seen.points[1] - detection.seen.points[0])) / 2
    ends = camera.project(detection.pose.apply(np.vstack([np.zeros(3), length * np.eye(3)])))
    if not np.isfinite(ends).all():
        return
    start, *tips = _fixed(ends).tolist()
    for tip, colour in zip(tips, AXES):
        cv2.line(image, start, tip, colour, line_width(image) + 1, cv2.LINE_AA, _SHIFT)


def write_label(image: Image, text: str, place: tuple[float, float]) -> None:
    """Write light text in a dark box into an image (H, W, 3).

    `place` is the lower left corner of the box; the box is moved if it leaves the image.
    """
    width = line_width(image)
    (long, high), below = cv2.getTextSize(text, _FONT, 0.5 * width, width)
    rim = 2 * width
    x = int(np.clip(place[0], rim, max(image.shape[1] - long - rim, rim)))
    y = int(np.clip(place[1], high + rim + below, max(image.shape[0] - 1, high + rim + below))) - below
    cv2.rectangle(image, (x - rim, y - high - rim), (x + long + rim, y + below), _PAPER, -1)
    cv2.putText(image, text, (x, y), _FONT, 0.5 * width, _INK, width, cv2.LINE_AA)


def _fixed(points: Floats) -> Floats:
    """Convert pixel coordinates to integers, scaled by 2**`_SHIFT`, as OpenCV's drawing functions expect."""
    fixed: Floats = np.rint(points * (1 << _SHIFT)).astype(np.int32)
    return fixed
