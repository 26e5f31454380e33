"""Rendered scenes with rocks and maintenance panels: images, depths, and the true boxes and positions of the objects.

The shipped model is trained with them, and the demo and tests play them. Rocks are shaded drawings that stand on the
ground; the parts of a panel are drawings on a plane. Light, colours, blur, noise and JPEG's losses are random. All
randomness comes from a seed, so a scene can be made again.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from roverkit.objects.scenes.panel import Panel
from roverkit.objects.scenes.panel_parts import PARTS
from roverkit.objects.scenes.rendered_camera import CAMERA, SIZE, ImagingConditions
from roverkit.objects.scenes.rocks_on_ground import RocksOnGround
from roverkit.objects.scenes.world import RenderedScene, SceneObject, looking

__all__ = ["CAMERA", "CLASSES", "SIZE", "RenderedScene", "SceneObject", "scenes", "sequence"]

CLASSES = ("rock", *PARTS)
"""Names of the classes; they are those of the enum DetectedObjectType."""


def scenes(seed: int, count: int) -> Iterator[RenderedScene]:
    """Yield independent scenes: about as many with rocks as with panels."""
    for number in range(count):
        rng = np.random.default_rng([seed, number])
        world = RocksOnGround(rng) if rng.random() < 0.5 else Panel(rng)
        yield world.seen_from(world.place(rng), rng, ImagingConditions(rng))


def sequence(seed: int, count: int, *, panel: bool) -> Iterator[RenderedScene]:
    """Yield the frames of a camera that moves past a panel, or past rocks; each object keeps its number."""
    rng = np.random.default_rng([seed, int(panel)])
    world = Panel(rng) if panel else RocksOnGround(rng)
    conditions = ImagingConditions(rng)
    first, last = world.way(rng)
    for step in np.linspace(0, 1, count):
        sway = 0.004 * np.sin(np.array([31, 23, 17]) * step)
        pose = looking(first[0] + step * (last[0] - first[0]) + sway, first[1] + step * (last[1] - first[1]))
        yield world.seen_from(pose, rng, conditions)
