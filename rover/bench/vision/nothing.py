"""Section `nothing`: false detections in frames without markers."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from roverkit.vision.images.rendering import render, texture

from bench.result import Group, SectionResult, Table
from rover.bench.vision.contestants import estimators
from rover.bench.vision.scenes import lens

SEED = 99


def measure(frames: int, say: Callable[[str], None]) -> SectionResult:
    """Count the detections of each contestant in textured frames without markers."""
    camera = lens()
    contestants = {name: one for name, one in estimators(camera).items() if "APRILTAG" not in name}
    seen = dict.fromkeys(contestants, 0)
    for index in range(1, frames + 1):
        rng = np.random.default_rng([SEED, index])
        frame = render(camera, texture(camera.size, rng), [], rng)
        for name, estimate in contestants.items():
            seen[name] += len(estimate(frame))
        if index % 100 == 0 or index == frames:
            say(f"frames without markers: {index} of {frames}")
    rows = [[name, str(count)] for name, count in seen.items()]
    table = Table("Frames without markers", ("", "false ids"), [Group(f"{frames} frames", rows)], ["Goal: none."])
    return SectionResult([table], (), {"frames": frames, "false_ids": seen})
