"""Section `receiving`: CPU for the images of a ROS 2 topic, beside a plain rclpy subscriber."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

from bench import ros2
from bench.errors import BenchError
from bench.process import Child
from bench.result import Group, SectionResult, Table
from rover.bench.vision.image_tools import RATE_HZ, SIZE
from roverlink.dds_domain import UNTIL_EXIT, claim_domain

GOAL_PERCENT = 15
_ENCODINGS = ("bgr8", "rgb8")
_START_S = 30.0
_TOOL = ("-m", "rover.bench.vision.image_tools")


@dataclass(frozen=True, slots=True)
class Receiving:
    """CPU of one receiver: percent of a core, and milliseconds per image; the images per second that it got."""

    name: str
    encoding: str
    percent: float
    milliseconds: float
    rate: float


def measure(seconds: float, out: Path, say: Callable[[str], None]) -> SectionResult:
    """Measure each receiver for some seconds, one after the other; `out` is the folder for their logs."""
    environment = {
        **os.environ,
        "ROS_DOMAIN_ID": str(claim_domain(UNTIL_EXIT)),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    }
    results = []
    for name, middleware, words in _receivers():
        # Camera and receiver use the same DDS: between two, large images come late and in bursts.
        python, more = (sys.executable, {}) if middleware == "dds" else (ros2.python(), ros2.environment())
        own = {**environment, **more}
        for encoding in _ENCODINGS:
            say(f"receiving: {name}, {encoding}")
            with (
                Child("camera", [python, *_TOOL, "camera", middleware, encoding], own, out),
                Child("receiver", [python, *_TOOL, *words], own, out) as receiver,
            ):
                results.append(_measured(name, encoding, receiver, seconds))
    rows = [
        [result.name, result.encoding, f"{result.percent:.1f}", f"{result.milliseconds:.2f}", f"{result.rate:.1f}"]
        for result in results
    ]
    columns = ("", "encoding", "CPU\n% of a core", "CPU\nms per image", "images\nper s")
    notes = [
        f"Goal for roverlink: under {GOAL_PERCENT} % of a core, with all threads of the process, also those of DDS.",
        "The camera of dds publishes over Cyclone DDS, that of rclpy over the default of ROS 2, Fast DDS.",
        "roverlink gives BGR images, so rgb8 includes a conversion; the plain subscriber gives the bytes as they are.",
    ]
    if not ros2.is_ready():
        notes.append("rclpy is not measured; `make test-ros2` installs it.")
    title = f"Receiving a topic with images of {SIZE[0]}x{SIZE[1]} at {RATE_HZ} Hz"
    table = Table(title, columns, [Group("", rows)], notes)
    return SectionResult([table], (), {"receiving": [asdict(one) for one in results]})


def _receivers() -> Iterator[tuple[str, str, list[str]]]:
    """Yield each receiver with the middleware of its camera, and its command."""
    yield "roverlink, dds", "dds", ["source", "dds"]
    if ros2.is_ready():
        yield "roverlink, rclpy", "rclpy", ["source", "rclpy"]
        yield "plain rclpy subscriber", "rclpy", ["rclpy"]


def _measured(name: str, encoding: str, receiver: Child, seconds: float) -> Receiving:
    deadline = time.monotonic() + _START_S
    while receiver.ask("frames")["frames"] < RATE_HZ:
        if time.monotonic() > deadline:
            raise BenchError(f"{name} has received no images of {encoding} for {_START_S:.0f} s")
        time.sleep(0.1)
    first, cpu, began = receiver.ask("frames")["frames"], receiver.cpu_seconds(), time.monotonic()
    time.sleep(seconds)
    frames, used = receiver.ask("frames")["frames"] - first, receiver.cpu_seconds() - cpu
    passed = time.monotonic() - began
    return Receiving(name, encoding, 100 * used / passed, 1e3 * used / max(frames, 1), frames / passed)
