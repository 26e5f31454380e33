"""Rows of the table whose messages report detected objects to the basestation, and select one of them."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import cast

from roverkit.objects.detected_objects import Box, TrackedObject
from roverkit.objects.object_declarations import DETECTED, SELECTION
from roverlink.runtime import Registry
from roverlink.runtime.core import cdr
from roverlink.runtime.core.messages import Message, fields_of

_LARGEST = 2**32


class DetectedObjectRow:
    """Row `DETECTED`: one message for each object of a frame."""

    def __init__(self, registry: Registry) -> None:
        """Find the row. Raises `SetupError` if it is missing, or lacks a field."""
        self.topic = DETECTED.of(registry)
        fields = {field.name: field.type for field in fields_of(self.topic.message_type)}
        self._box = cast("type[Message]", fields["bbox"])
        self._frames = itertools.count(1)

    @property
    def types(self) -> Mapping[str, int]:
        """Numbers of the types of objects by their names in the proto, such as ``OBJECT_ROCK``."""
        constants = vars(self.topic.message_type).items()
        return {name: value for name, value in constants if name.isupper() and isinstance(value, int)}

    def messages(self, objects: Sequence[tuple[TrackedObject, int]], size: tuple[int, int]) -> Iterator[bytes]:
        """Yield the serialized messages of the next frame, for its objects with the numbers of their types.

        ``size`` is the width and height of the image, to which the boxes are clipped. A frame without objects is one
        message with the total count 0, so that the basestation can tell it from a camera that has failed.
        """
        frame = next(self._frames) % _LARGEST
        for index, (tracked, type_) in enumerate(objects):
            box = self._box(**dict(zip(("x", "y", "width", "height"), _pixels(tracked.box, size))))
            yield cdr.encode(
                self.topic.message_type(
                    frame_id=frame,
                    total_count=len(objects),
                    index=index,
                    id=tracked.id,
                    type=type_,
                    bbox=box,
                    confidence=tracked.confidence,
                )
            )
        if not objects:
            yield cdr.encode(self.topic.message_type(frame_id=frame))


class ObjectSelectionRow:
    """Row `SELECTION`: the number of the object that the operator has selected."""

    def __init__(self, registry: Registry) -> None:
        """Find the row. Raises `SetupError` if it is missing, or lacks the field."""
        self.topic = SELECTION.of(registry)

    def number(self, data: bytes) -> int:
        """Return the object's number in a serialized message. Raises `ConversionError` if it is damaged."""
        return int(getattr(cdr.decode(self.topic.message_type, data), SELECTION.fields[0]))


def _pixels(box: Box, size: tuple[int, int]) -> tuple[int, int, int, int]:
    """Return x, y, width and height of a box in whole pixels of an image: at least one pixel, inside the image."""
    starts, lengths = [], []
    for start, length, end in zip((box.x, box.y), (box.width, box.height), size):
        first = min(max(round(start), 0), end - 1)
        starts.append(first)
        lengths.append(max(min(round(start + length), end) - first, 1))
    return starts[0], starts[1], lengths[0], lengths[1]
