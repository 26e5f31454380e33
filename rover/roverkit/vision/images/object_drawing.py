"""Drawing of detected objects into an image."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from roverkit.objects.detected_objects import TrackedObject
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
    drawn = to_colour(image)
    for tracked in objects:
        box, colour = tracked.box, _COLOURS[tracked.id % len(_COLOURS)]
        corners = [(round(box.x), round(box.y)), (round(box.x + box.width), round(box.y + box.height))]
        cv2.rectangle(drawn, *corners, colour, line_width(drawn) + 1, cv2.LINE_AA)
    for tracked in objects:  # after all boxes, which would cross them
        location = locations.get(tracked.id)
        distance = f" {location.point[2]:.1f} m" if location else ""
        place = tracked.box.x, tracked.box.y - 4 * line_width(drawn)
        write_label(drawn, f"{tracked.id} {tracked.class_name}{distance}", place)
    return drawn
