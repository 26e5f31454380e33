"""Camera of ``roverlink demo`` that sees a panel: ``roverlink objects track`` detects its parts."""

from __future__ import annotations

import roverkit.vision  # noqa: F401  # first: it explains how to install numpy and OpenCV

# isort: split

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from roverkit.demo.camera_program import CameraProgram
from roverkit.objects.detected_objects import Box, TrackedObject
from roverkit.objects.metrics import overlap
from roverkit.objects.object_declarations import DETECTED
from roverkit.objects.object_rows import DetectedObjectRow
from roverkit.objects.object_types import ClassesFile, ObjectTypes
from roverkit.objects.runtime_session import import_runtime
from roverkit.objects.scenes import CLASSES, SIZE, sequence
from roverkit.vision.opencv import cv2
from roverlink.numerals import counted
from roverlink.runtime import SetupError
from roverlink.runtime.middleware import Middleware
from roverlink.simulation.demo_parts import DemoSetting
from roverlink.topic_types import full_topic

_FRAMES = 30
_SEED = 4
_OVERLAP = 0.5
"""Overlap with the truth from which an object counts as found."""


class ObjectCamera(CameraProgram):
    """Camera that moves past a panel."""

    rows = (DETECTED.row,)

    def __init__(self, setting: DemoSetting) -> None:
        """Render the images, and prepare the command line. Raises `SetupError` if ONNX Runtime is not installed."""
        import_runtime()
        self._scenes = list(sequence(_SEED, _FRAMES, panel=True))
        self._publish: Callable[[list[TrackedObject]], None] = lambda _: None
        self._frames = self._there = self._found = 0
        super().__init__(setting, "objects")

    def _words(self, folder: Path) -> Sequence[str]:
        for number, scene in enumerate(self._scenes):
            cv2.imwrite(str(folder / f"{number}.png"), scene.image)
        return ["objects", "track", str(folder), "--rate", "10", "--loop"]

    def _publish_on(self, middleware: Middleware) -> None:
        try:
            row = DetectedObjectRow(self._setting.registry)
        except SetupError:  # another project's table
            return
        types = ObjectTypes(ClassesFile(), row.types, CLASSES, lambda _: None)
        publisher = row.topic.publisher(middleware, full_topic)

        def publish(objects: list[TrackedObject]) -> None:
            publisher.publish(list(row.messages([(shown, types.of(shown.class_name)) for shown in objects], SIZE)))

        self._publish = publish

    @property
    def result(self) -> str:
        """Number of images, and the part of the objects that was found."""
        part = self._found / max(self._there, 1)
        return f"a simulated camera searched {counted(self._frames, 'frame')} for objects; it found {part:.0%} of them"

    def _take(self, view: dict[str, Any]) -> None:
        objects = [
            TrackedObject(entry["id"], Box(**entry["box"]), entry["class"], entry["confidence"])
            for entry in view["objects"]
        ]
        self._publish(objects)
        self._frames += 1
        if self._frames == 1:
            return  # an object comes out when it is detected for the second time
        for truth in self._scenes[view["frame"] % len(self._scenes)].objects:
            self._there += 1
            self._found += any(
                shown.class_name == truth.class_name and overlap(shown.box, truth.box) >= _OVERLAP for shown in objects
            )
