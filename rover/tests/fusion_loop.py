"""``roverlink fuse`` as a program, with what a simulated rover publishes on a drive."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from polling import wait_until
from programs import Start
from roverkit.fusion.fusion_declaration import DETECTIONS, FUSED, ODOMETRY

from rover.tests.driving.field_drive import FieldDrive
from rover.tests.driving.simulated_tracker import write_field
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces.nav_msgs import Odometry
from roverlink.runtime.interfaces.vision_msgs import Detection3DArray

_METRES = 8.0
_CAMERA = "front"
TOPICS: Mapping[str, type[Message]] = {f"/{ODOMETRY.name}": Odometry, f"/{_CAMERA}/{DETECTIONS.name}": Detection3DArray}
"""Topics of the rover, with the types of their messages."""

Send = Callable[[str, bytes], None]
"""Function that publishes a serialized message on a topic."""


def fuse_a_drive(
    start: Start, middleware: str, folder: Path, send: Send, poses: Callable[[], Sequence[Mapping[str, Any]]]
) -> None:
    """Play a drive to the program; its last pose on `FUSED` is that of the rover.

    ``poses`` returns what has come on that topic. ``send`` waits until the program hears the topic.
    """
    landmarks, cameras = write_field(folder, _CAMERA)
    program = start("fuse", "--landmarks", landmarks, "--cameras", cameras, "--middleware", middleware)
    sent: list[tuple[str, bytes]] = []
    with ExitStack() as stack:
        rover = FieldDrive(1, stack)
        for own, topic in zip((ODOMETRY.name, DETECTIONS.name), TOPICS, strict=True):
            rover.middleware.subscribe(
                f"/{own}", TOPICS[topic], Qos(), lambda many, topic=topic: sent.extend((topic, one) for one in many)
            )
        rover.stand(2)
        rover.drive(_METRES)
        truth, last = rover.model.pose, rover.fused[-1].header.stamp
    program.wait_for(f"waiting for /{ODOMETRY.name}")
    for topic, data in sent:
        send(topic, data)

    def end() -> Sequence[Mapping[str, Any]]:
        stamps = [(one, one["header"]["stamp"]) for one in list(poses())[-1:]]
        return [one for one, stamp in stamps if (stamp["sec"], stamp["nanosec"]) == (last.sec, last.nanosec)]

    (pose,) = wait_until(end, f"the last pose on /{FUSED.name}")
    place = pose["pose"]["pose"]["position"]
    assert pose["header"]["frame_id"] == "map"
    assert math.hypot(place["x"] - truth.x, place["y"] - truth.y) < 0.15
    assert program.interrupt() == 0
