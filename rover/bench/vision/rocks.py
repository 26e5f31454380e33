"""Section `rocks`: lengths and widths of rendered rocks, beside simpler computations."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import cv2
import numpy as np
from roverkit.rocks.ground import fit_ground
from roverkit.rocks.measurement import measure as measure_rock
from roverkit.rocks.unmeasurable import UnmeasurableError

from bench.result import Group, SectionResult, Table
from rover.bench.vision.contestants import OURS
from rover.bench.vision.rock_scenes import RockScene, camera, scenes

SEED = 3
KINDS: dict[str, dict[str, Any]] = {
    "ellipsoids": {},
    "irregular rocks: noise of 3.5 % of the radius": {"bumps": 0.035},
    "very irregular rocks: 6 %": {"bumps": 0.06},
    "widest part above the ground: at 0.3 of half the height": {"lift": 0.3},
    "line away from the camera: 60 to 90 degrees": {"bumps": 0.035, "turn": (60, 90)},
    "angular rocks: 30 faces": {"faces": 30},
    "angular rocks: 16 faces": {"faces": 16},
    "slabs": {"faces": 10, "slab": True},
    "angular rocks that touch another one": {"faces": 30, "touched": True},
}
"""Arguments of `scenes` for each kind of rock."""
TWO_PIXELS = "depth at the two pixels"
NEAR_SIDE = "rays and plane, twice the near side"
_RING = (0.45, 1.0)
_HIGH = 0.005  # metres above the ground from which a point belongs to the rock, if the noise is smaller
_EXTENT = 0.98  # quantile of the distances from the line


@dataclass(frozen=True, slots=True)
class RockError:
    """Errors of a measurement of one rock in percent; NaN if there is no result."""

    kind: str
    contestant: str
    length: float
    width: float
    length_sigma: float
    """Standard deviation that the contestant claims, in percent; NaN if it claims none."""
    width_sigma: float
    seconds: float


def measure_rocks(
    count: int, kinds: Iterable[str] = KINDS, say: Callable[[str], None] = lambda _: None
) -> Iterator[RockError]:
    """Yield the errors of each contestant for `count` rocks of each kind."""
    for kind in kinds:
        for scene in scenes(count, SEED, **KINDS[kind]):
            for name, contestant in _CONTESTANTS.items():
                before = time.perf_counter()
                length, width, *sigmas = contestant(scene)
                seconds = time.perf_counter() - before
                errors = 100 * (length / scene.length - 1), 100 * (width / scene.width - 1)
                length_sigma, width_sigma = sigmas or (np.nan, np.nan)
                claimed = 100 * length_sigma / scene.length, 100 * width_sigma / scene.width
                yield RockError(kind, name, *errors, *claimed, seconds)
        say(f"rocks: {kind}")


def measure(count: int, say: Callable[[str], None]) -> SectionResult:
    """Measure `count` rocks of each kind."""
    found = list(measure_rocks(count, say=say))
    table = Table(
        f"Rocks, {count} of each kind, 640x480, distances of 0.6 to 2 m",
        ("error, %", "length\nmedian", "90 %", "width\nmedian", "90 %", "inside 95 %", "no result", "ms", "largest"),
        [Group(kind, [_row(name, found, kind) for name in _CONTESTANTS]) for kind in KINDS],
        [
            "Goals for the first two kinds: length 1.5 and 4 %, width 4 and 8 %, 200 ms.",
            "Inside 95 %: the share of lengths and widths whose error is at most 1.96 times the claimed sigma.",
            "A line's endpoints are wrong by 0.5 px (standard deviation), and rounded to whole pixels.",
        ],
    )
    return SectionResult([table], (), {"rocks": [asdict(result) for result in found]})


def quantiles(errors: Sequence[float]) -> tuple[float, float]:
    """Return the median and the 90 % quantile of the absolute values of errors; those that are NaN are left out."""
    known = np.abs([error for error in errors if not np.isnan(error)])
    return (float(np.median(known)), float(np.quantile(known, 0.9))) if known.size else (np.nan, np.nan)


def covered(found: Sequence[RockError]) -> tuple[float, float]:
    """Return the shares of the lengths and of the widths whose error is at most 1.96 claimed standard deviations."""
    known = [one for one in found if not np.isnan(one.length_sigma)]
    if not known:
        return np.nan, np.nan
    return (
        float(np.mean([abs(one.length) <= 1.96 * one.length_sigma for one in known])),
        float(np.mean([abs(one.width) <= 1.96 * one.width_sigma for one in known])),
    )


def _row(name: str, found: Sequence[RockError], kind: str) -> tuple[str, ...]:
    chosen = [result for result in found if (result.kind, result.contestant) == (kind, name)]
    numbers = *quantiles([one.length for one in chosen]), *quantiles([one.width for one in chosen])
    missing = sum(np.isnan(one.length) for one in chosen)
    times = [1000 * run.seconds for run in chosen]
    texts = ("" if np.isnan(number) else f"{number:.1f}" for number in numbers)
    shares = ", ".join("" if np.isnan(share) else f"{100 * share:.0f}" for share in covered(chosen)).strip(", ")
    return name, *texts, shares, str(missing), f"{np.median(times):.0f}", f"{max(times):.0f}"


def _ours(scene: RockScene) -> tuple[float, ...]:
    try:
        size = measure_rock(scene.depth, camera(), scene.line)
    except UnmeasurableError:
        return (np.nan,) * 4
    return size.length, size.width, size.length_sigma, size.width_sigma


def _near_side(scene: RockScene) -> tuple[float, float]:
    """Measure where the endpoints' rays meet the ground, and twice the extent from there to the camera's side."""
    ends = np.reshape(scene.line, (2, 2)).astype(float)
    height, width = scene.depth.shape
    x, y = np.meshgrid(np.arange(width), np.arange(height))
    pixels = np.stack([x, y], axis=-1).reshape(-1, 2)
    way = ends[1] - ends[0]
    along = np.clip((pixels - ends[0]) @ way / (way @ way), 0, 1)
    distances = np.linalg.norm(pixels - ends[0] - along[:, None] * way, axis=1) / np.linalg.norm(way)
    depth = scene.depth.ravel()
    ring = np.isfinite(depth) & (distances > _RING[0]) & (distances <= _RING[1])
    directions = np.append(camera().undistort(pixels.astype(float)), np.ones((len(pixels), 1)), axis=1)
    step = max(int(ring.sum()) // 6000, 1)
    ground = fit_ground(directions[ring][::step], depth[ring][::step])
    if ground is None:
        return np.nan, np.nan
    first, last = ground.meet(np.append(camera().undistort(ends), np.ones((2, 1)), axis=1))
    length = float(np.linalg.norm(last - first))
    axis = (last - first) / length
    side = np.cross(ground.normal, axis)
    side *= np.sign(-first @ side)
    points = directions * depth[:, None]
    share = (points - first) @ axis / length
    across = (points - first) @ side
    heights = points @ ground.normal + ground.height
    noise = 1.4826 * np.nanmedian(np.abs(heights[ring]))  # standard deviation of a normal distribution
    rock = heights > max(_HIGH, 3 * noise)
    rock &= (share > 0) & (share < 1) & (across > 0) & (distances <= _RING[1])
    count, parts, areas, _ = cv2.connectedComponentsWithStats(rock.reshape(height, width).astype(np.uint8))
    if count == 1:
        return length, np.nan
    rock = parts.ravel() == 1 + int(np.argmax(areas[1:, cv2.CC_STAT_AREA]))
    return length, 2 * float(np.quantile(across[rock], _EXTENT))


def _two_pixels(scene: RockScene) -> tuple[float, float]:
    x1, y1, x2, y2 = scene.line
    rays = np.append(camera().undistort(np.array([[x1, y1], [x2, y2]], dtype=float)), np.ones((2, 1)), axis=1)
    first, last = rays * np.array([[scene.depth[y1, x1]], [scene.depth[y2, x2]]])
    return float(np.linalg.norm(last - first)), np.nan


_CONTESTANTS: dict[str, Callable[[RockScene], tuple[float, ...]]] = {
    OURS: _ours,
    NEAR_SIDE: _near_side,
    TWO_PIXELS: _two_pixels,
}
