"""Section `speed`: time for a frame of 1280x720 pixels with four markers: tracked, fully scanned, and by OpenCV."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from roverkit.vision.markers.marker_set import MarkerSet
from roverkit.vision.markers.tracker import Tracker

from bench.result import Group, SectionResult, Table
from rover.bench.vision.contestants import OURS, camera_of, plain_detector
from rover.bench.vision.scenes import SIDE, DriveFrame, drive, lens

SIZE = (1280, 720)
SEED = 3
_WARM_UP = 2


@dataclass(frozen=True, slots=True)
class Timing:
    """Milliseconds per frame, and the share of markers found."""

    name: str
    median: float
    p95: float
    seen: float
    goal: str


def measure(frames: int, say: Callable[[str], None]) -> SectionResult:
    """Time a drive with each method, interleaved, so that other load on the machine affects all alike."""
    say(f"rendering {frames} frames of a drive")
    film = list(drive(frames + _WARM_UP, SEED, SIZE))
    camera, markers = camera_of(lens(*SIZE)), MarkerSet(side=SIDE)
    tracking, scanning = Tracker(camera, markers), Tracker(camera, markers, scan_s=0, thorough_s=0)
    plain = plain_detector()
    looks: dict[str, tuple[Callable[[DriveFrame], int], str]] = {
        f"{OURS}, tracking": (lambda shot: len(tracking.track(shot.frame, shot.stamp)), "12"),
        f"{OURS}, thorough scan": (lambda shot: len(scanning.track(shot.frame, shot.stamp)), "35"),
        "OpenCV, default scan": (lambda shot: _count(plain.detectMarkers(shot.frame)[1]), ""),
    }
    times: dict[str, list[float]] = {name: [] for name in looks}
    seen: dict[str, list[int]] = {name: [] for name in looks}
    for shot in film:
        for name, (look, _) in looks.items():
            start = time.perf_counter()
            seen[name].append(look(shot))
            times[name].append(1e3 * (time.perf_counter() - start))
    say(f"speed: {frames} frames")
    results = [_timing(name, times[name][_WARM_UP:], seen[name], film, goal) for name, (_, goal) in looks.items()]
    rows = [
        [result.name, f"{result.median:.1f}", f"{result.p95:.1f}", f"{result.seen:.0f}", result.goal]
        for result in results
    ]
    notes = ["roverlink: detection, edge fit and pose; OpenCV: detection only. Scans of the whole frame are included."]
    columns = ("", "median\nms", "p95\nms", "seen\n%", "goal\nms")
    table = Table("Time per frame, 1280x720, four markers", columns, [Group("", rows)], notes)
    return SectionResult([table], (), {"speed": [asdict(one) for one in results]})


def _count(numbers: Any) -> int:
    return 0 if numbers is None else len(numbers)


def _timing(name: str, times: Sequence[float], seen: Sequence[int], film: Sequence[DriveFrame], goal: str) -> Timing:
    there = sum(len(shot.poses) for shot in film)
    return Timing(name, float(np.median(times)), float(np.percentile(times, 95)), 100 * sum(seen) / there, goal)
