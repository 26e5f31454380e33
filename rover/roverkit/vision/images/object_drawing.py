"""Drawing of detected objects into an image."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from roverkit.objects.detected_objects import Box, ObjectDetection, TrackedObject
from roverkit.objects.location import Location
from roverkit.vision.images.drawing import Colour, line_width, write_label
from roverkit.vision.markers.detection import Image, to_colour
from roverkit.vision.opencv import cv2

# Colours (BGR) that differ for people who see no red or green, too: those of Okabe and Ito.
_COLOURS: tuple[Colour, ...] = (
    (0, 159, 230),
    (233, 180, 86),
    (115, 158, 0),
    (66, 228, 240),
    (178, 114, 0),
    (0, 94, 213),
    (167, 121, 204),
)


def draw_objects(image: Image, objects: Sequence[TrackedObject], locations: Mapping[int, Location]) -> Image:
    """Return a copy (H, W, 3) of an image with the box, number, class and distance of each object drawn into it.

    `locations` has the positions that are known, by the numbers of the objects.
    """
    return _drawn(
        image,
        [
            (tracked.box, tracked.id, f"{tracked.id} {tracked.class_name}{_distance(locations.get(tracked.id))}")
            for tracked in objects
        ],
    )


def draw_detections(image: Image, objects: Sequence[ObjectDetection]) -> Image:
    """Return a copy (H, W, 3) of an image with the box, class and confidence of each object drawn into it."""
    names = sorted({detected.class_name for detected in objects})
    return _drawn(
        image,
        [
            (detected.box, names.index(detected.class_name), f"{detected.class_name} {detected.confidence:.2f}")
            for detected in objects
        ],
    )


def _drawn(image: Image, boxes: Sequence[tuple[Box, int, str]]) -> Image:
    """Return a copy of an image with boxes, each with the number of its colour and its label."""
    drawn = to_colour(image)
    for box, number, _ in boxes:
        corners = [(round(box.x), round(box.y)), (round(box.x + box.width), round(box.y + box.height))]
        cv2.rectangle(drawn, *corners, _COLOURS[number % len(_COLOURS)], line_width(drawn) + 1, cv2.LINE_AA)
    for box, _, label in boxes:  # after all boxes, which would cross them
        write_label(drawn, label, (box.x, box.y - 4 * line_width(drawn)))
    return drawn


def _distance(location: Location | None) -> str:
    return f" {location.point[2]:.1f} m" if location else ""
