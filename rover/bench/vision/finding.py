"""Section `finding`: share of difficult markers that are found, frames until a new one is found, and many at once.

Everything is compared with OpenCV's detector with its defaults, on the same frames.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass

import cv2
import numpy as np
from roverkit.vision.images.rendering import (
    NOISE_SIGMA,
    Floats,
    Grey,
    Lens,
    Pose,
    Print,
    marker_print,
    render,
    render_light,
    texels_for,
    texture,
)
from roverkit.vision.markers.marker_set import MarkerSet
from roverkit.vision.markers.tracker import Tracker

from bench.result import Group, SectionResult, Table
from rover.bench.vision.contestants import OURS, camera_of, plain_detector
from rover.bench.vision.degradations import Light, defocus, motion_blur
from rover.bench.vision.scenes import DICTIONARY, FOCAL, SIDE, DriveFrame, lens, random_pose

SEED = 11
COVERED = (24, 32, 48, 96)
LARGE = (300, 450, 600)
TWICE = (32, 96)
PATCHED = (48, 96)
NEW = {"sharp": (18, 20, 22), "defocus 2 px": (20, 24, 28), "motion 4 px": (20, 24, 28)}
"""Sides in pixels of new markers, by their blur."""
WAITED = 30
"""Frames after which a new marker counts as not found."""
SOON = 3
"""Frames within which a new marker is to be found."""
MANY = 12
_FRAME_NS = 33_000_000
_SMALL, _WIDE = (640, 480), (1280, 720)
_BARS, _BAR = 2, 0.4  # number of the bars over a marker's interior, and their width in modules
_PATCH = (1.2, 2.4)  # least and largest side in modules of the patch over a marker's interior
_RASTER = 200  # side in pixels of a marker whose image is scaled when it is printed
_WARM_UP = 2


@dataclass(frozen=True, slots=True)
class Share:
    """Percentage of the markers that both contestants found, for one kind and size of marker."""

    kind: str
    side_px: int
    ours: float
    plain: float


@dataclass(frozen=True, slots=True)
class Wait:
    """Frames until a new marker was found: percentage within `SOON` frames, and the 90th percentile."""

    name: str
    blur: str
    side_px: int
    soon: float
    p90: float


@dataclass(frozen=True, slots=True)
class Cost:
    """Milliseconds of CPU time per frame with `MANY` moving markers, and the percentage of markers found."""

    name: str
    mean: float
    p95: float
    seen: float


_BLURS: dict[str, Callable[[Light, np.random.Generator], Light]] = {
    "sharp": lambda light, _: light,
    "defocus 2 px": defocus(2),
    "motion 4 px": motion_blur(4),
}
Finder = Callable[[Grey, int], Sequence[int]]
"""Function that returns the numbers of the markers in a frame with a stamp in nanoseconds."""


def measure(scenes: int, frames: int, say: Callable[[str], None]) -> SectionResult:
    """Measure all kinds of markers with `scenes` frames each, and the cost of many markers with `frames` frames."""
    shares = []
    for kind, (sizes, _) in _KINDS.items():
        for side_px in sizes:
            shares.append(found_share(kind, side_px, scenes))
            say(f"{kind} markers of {side_px} px: found {shares[-1].ours:.0f} %, OpenCV {shares[-1].plain:.0f} %")
    waits = []
    for blur, sizes in NEW.items():
        for side_px in sizes:
            waits += new_waits(blur, side_px, scenes)
            ours, plain = (f"{wait.soon:.0f} %" for wait in waits[-2:])
            say(f"new markers, {blur}, of {side_px} px: {ours} within {SOON} frames, OpenCV {plain}")
    costs = _costs(frames)
    tables = [_share_table(shares, scenes), _wait_table(waits), _cost_table(costs)]
    data = {
        "shares": [asdict(share) for share in shares],
        "waits": [asdict(wait) for wait in waits],
        "costs": [asdict(cost) for cost in costs],
    }
    return SectionResult(tables, (), data)


# --- scenes ---


@dataclass(frozen=True, slots=True)
class Shown:
    """Frame, the lens that took it, and the numbers of the markers in it."""

    frame: Grey
    camera: Lens
    numbers: Sequence[int]


def covered(
    side_px: int, count: int, cover: Callable[[Print, np.random.Generator], Print] | None = None
) -> Iterator[Shown]:
    """Yield frames with a marker whose interior, inside the black border, is covered; by default, bars cross it."""
    camera = lens(*_SMALL)
    for rng in _generators(side_px, count):
        number, pose = int(rng.integers(250)), random_pose(camera, side_px, rng)
        plane = (cover or _crossed)(marker_print(DICTIONARY, number, SIDE, texels=texels_for(side_px)), rng)
        yield Shown(_rendered(camera, [(plane, pose)], rng), camera, [number])


def patched(side_px: int, count: int) -> Iterator[Shown]:
    """Yield frames with a marker whose interior, inside the black border, has a grey patch."""
    return covered(side_px, count, _patched)


def large(side_px: int, count: int) -> Iterator[Shown]:
    """Yield frames with a large marker whose modules differ in size, because its printed image has few pixels."""
    camera = lens(*_WIDE)
    for rng in _generators(side_px, count):
        number = int(rng.integers(250))
        pose = _facing(camera, (0.5, 0.5), side_px, rng, tilt=0.1)
        yield Shown(_rendered(camera, [(raster_print(number, _RASTER), pose)], rng), camera, [number])


def twice(side_px: int, count: int) -> Iterator[Shown]:
    """Yield frames with two markers that share a number."""
    camera = lens(*_SMALL)
    for rng in _generators(side_px, count):
        number = int(rng.integers(250))
        plane = marker_print(DICTIONARY, number, SIDE, texels=texels_for(side_px))
        planes = [(plane, _facing(camera, place, side_px, rng)) for place in ((0.25, 0.5), (0.75, 0.5))]
        yield Shown(_rendered(camera, planes, rng), camera, [number, number])


def moving(count: int, markers: int) -> Iterator[DriveFrame]:
    """Yield frames of 1280x720 pixels in which markers of 40 to 70 pixels move on circles, 10 pixels per frame."""
    camera, rng = lens(*_WIDE), np.random.default_rng(SEED)
    scene, columns = texture(_WIDE, rng), 4
    rows = -(-markers // columns)
    starts = []
    for index, number in enumerate(rng.permutation(250)[:markers].tolist()):
        place = ((index % columns + 0.5) / columns, (index // columns + 0.5) / rows)
        side_px = float(rng.uniform(40, 70))
        plane = marker_print(DICTIONARY, number, SIDE, texels=texels_for(side_px))
        starts.append((number, plane, _facing(camera, place, side_px, rng), float(rng.uniform(0, 2 * np.pi))))
    for frame in range(count):
        planes = [(plane, _circled(pose, phase + frame / 4)) for _, plane, pose, phase in starts]
        poses = {number: pose for (number, *_), (_, pose) in zip(starts, planes)}
        yield DriveFrame(render(camera, scene, planes, rng), frame * _FRAME_NS, poses)


_KINDS: dict[str, tuple[Sequence[int], Callable[[int, int], Iterator[Shown]]]] = {
    "covered": (COVERED, covered),
    "patched": (PATCHED, patched),
    "large": (LARGE, large),
    "twice": (TWICE, twice),
}


def _generators(side_px: int, count: int) -> Iterator[np.random.Generator]:
    return (np.random.default_rng([SEED, side_px, index]) for index in range(count))


def _rendered(
    camera: Lens, planes: Sequence[tuple[Print, Pose]], rng: np.random.Generator, noise_sigma: float = NOISE_SIGMA
) -> Grey:
    return render(camera, texture(camera.size, rng), planes, rng, noise_sigma=noise_sigma)


def _facing(
    camera: Lens, place: tuple[float, float], side_px: float, rng: np.random.Generator, *, tilt: float = 0.3
) -> Pose:
    """Return a pose of a marker turned by up to `tilt` radians about each axis; `place` is relative to the image."""
    ray = camera.rays(np.array(place) * camera.size)
    turn = cv2.Rodrigues(rng.uniform(-tilt, tilt, 3))[0] @ np.diag([1.0, -1.0, -1.0])
    return Pose(turn, np.append(ray, 1.0) * SIDE * FOCAL / side_px)


def _circled(pose: Pose, angle: float) -> Pose:
    """Move a pose by 40 pixels in the direction `angle`."""
    shift = 40 / FOCAL * pose.translation[2] * np.array([np.cos(angle), np.sin(angle), 0])
    return Pose(pose.rotation, pose.translation + shift)


def _patched(plane: Print, rng: np.random.Generator) -> Print:
    """Draw a grey rectangle over a part of the interior of a marker."""
    image, module = plane.image.copy(), len(plane.image) // 9
    size = rng.uniform(*_PATCH, 2) * module
    low = rng.uniform(2 * module, 7 * module - size)
    (left, top), (right, bottom) = np.rint(low).astype(int), np.rint(low + size).astype(int)
    image[top:bottom, left:right] = round(rng.uniform(25, 225))
    return Print(image, plane.metres_per_pixel)


def _crossed(plane: Print, rng: np.random.Generator) -> Print:
    """Draw grey bars over the interior of a marker, inside its black border."""
    image, modules = plane.image.copy(), 9  # 5 of the interior, and the black and the white border
    module = len(image) // modules
    inside = image[2 * module : -2 * module, 2 * module : -2 * module]
    drawn = np.ascontiguousarray(inside)
    for _ in range(_BARS):
        middle, angle = rng.uniform(0, len(inside), 2), rng.uniform(0, np.pi)
        reach = len(inside) * np.array([np.cos(angle), np.sin(angle)])
        start, end = (np.rint(point).astype(int).tolist() for point in (middle - reach, middle + reach))
        cv2.line(drawn, start, end, float(rng.uniform(25, 225)), max(1, round(_BAR * module)))
    inside[:] = drawn
    return Print(image, plane.metres_per_pixel)


def raster_print(number: int, pixels: int) -> Print:
    """Return a printed marker whose image has a side of `pixels`, so its modules differ by a pixel of the image."""
    bits = cv2.aruco.getPredefinedDictionary(DICTIONARY)
    image = np.pad(np.asarray(bits.generateImageMarker(number, pixels)), pixels // 7, constant_values=255)
    return Print(np.where(image > 127, 225, 25).astype(np.uint8), SIDE / pixels)


# --- measurements ---


def _ours(tracker: Tracker) -> Finder:
    return lambda frame, stamp: [
        detection.id for detection in tracker.track(frame, stamp) if isinstance(detection.id, int)
    ]


def _plain(frame: Grey) -> list[int]:
    numbers = plain_detector().detectMarkers(frame)[1]
    return [] if numbers is None else np.reshape(numbers, -1).tolist()


def found_share(kind: str, side_px: int, scenes: int) -> Share:
    """Return the share of the markers of one kind and size that are found in single frames."""
    counts, there = np.zeros(2), 0
    for shown in _KINDS[kind][1](side_px, scenes):
        there += len(shown.numbers)
        look = _ours(Tracker(camera_of(shown.camera), MarkerSet(side=SIDE)))
        for place, found in enumerate((look(shown.frame, 0), _plain(shown.frame))):
            counts[place] += sum(number in shown.numbers for number in found)
    return Share(kind, side_px, *(100 * counts / there).tolist())


def new_waits(blur: str, side_px: int, count: int) -> list[Wait]:
    """Return how long new markers of a size are not seen; the frames before them are empty."""
    camera, waited = lens(*_SMALL), np.zeros((2, count))
    for index, rng in enumerate(_generators(side_px, count)):
        number, place = int(rng.integers(250)), rng.uniform(0.2, 0.8, 2)
        plane, pose = marker_print(DICTIONARY, number, SIDE), _facing(camera, (place[0], place[1]), side_px, rng)
        scene = texture(camera.size, rng)
        empty, full = (
            _BLURS[blur](render_light(camera, scene, planes), rng).astype(float) for planes in ([], [(plane, pose)])
        )
        look, before = _ours(Tracker(camera_of(camera), MarkerSet(side=SIDE))), int(rng.integers(1, WAITED))
        for frame in range(before):
            look(_noisy(empty, rng), frame * _FRAME_NS)
        noisy = [_noisy(full, rng) for _ in range(WAITED)]
        stamps = range(before * _FRAME_NS, (before + WAITED) * _FRAME_NS, _FRAME_NS)
        ours = (look(frame, stamp) for frame, stamp in zip(noisy, stamps))
        for row, found in enumerate((ours, map(_plain, noisy))):
            waited[row, index] = next((frame for frame, numbers in enumerate(found, 1) if number in numbers), np.inf)
    return [
        Wait(name, blur, side_px, 100 * float((row <= SOON).mean()), float(np.percentile(row, 90, method="lower")))
        for name, row in zip((OURS, "OpenCV"), waited)
    ]


def _noisy(frame: Floats, rng: np.random.Generator) -> Grey:
    return np.clip(np.rint(frame + rng.normal(0, NOISE_SIGMA, frame.shape)), 0, 255).astype(np.uint8)


def _costs(frames: int) -> list[Cost]:
    """Return the cost of many moving markers. CPU time, so that other load on the machine changes little."""
    tracker = Tracker(camera_of(lens(*_WIDE)), MarkerSet(side=SIDE))
    looks: dict[str, Finder] = {OURS: _ours(tracker), "OpenCV, default scan": lambda frame, _: _plain(frame)}
    times: dict[str, list[float]] = {name: [] for name in looks}
    seen = dict.fromkeys(looks, 0)
    for shot in moving(frames + _WARM_UP, MANY):
        for name, look in looks.items():
            start = time.process_time()
            found = look(shot.frame, shot.stamp)
            times[name].append(1e3 * (time.process_time() - start))
            seen[name] += sum(number in shot.poses for number in found)
    there = MANY * (frames + _WARM_UP)
    return [
        Cost(name, float(np.mean(took[_WARM_UP:])), float(np.percentile(took[_WARM_UP:], 95)), 100 * seen[name] / there)
        for name, took in times.items()
    ]


# --- tables ---


def _share_table(shares: Sequence[Share], scenes: int) -> Table:
    notes = [
        f"covered: {_BARS} bars of {_BAR} modules cross the interior; patched: a grey patch "
        "of {} to {} modules; large: modules of unequal size, 1280x720; ".format(*_PATCH)
        + "twice: two markers with one number."
    ]
    rows = [[f"{share.kind}, {share.side_px} px", f"{share.ours:.0f}", f"{share.plain:.0f}"] for share in shares]
    return Table(
        "Markers found in single frames", ("", f"{OURS}\n%", "OpenCV\n%"), [Group(f"{scenes} frames each", rows)], notes
    )


def _wait_table(waits: Sequence[Wait]) -> Table:
    groups = [
        Group(
            f"{blur}, 640x480",
            [
                [f"{wait.name}, {wait.side_px} px", f"{wait.soon:.0f}", f"{wait.p90:.0f}"]
                for wait in waits
                if wait.blur == blur
            ],
        )
        for blur in NEW
    ]
    return Table("Frames until a new marker is found", ("", f"within {SOON}\n%", "p90\nframes"), groups)


def _cost_table(costs: Sequence[Cost]) -> Table:
    rows = [[cost.name, f"{cost.mean:.1f}", f"{cost.p95:.1f}", f"{cost.seen:.0f}"] for cost in costs]
    notes = ["roverlink: detection, edge fit and pose; OpenCV: detection only."]
    columns = ("", "mean\nms CPU", "p95\nms CPU", "seen\n%")
    return Table(f"Time per frame, 1280x720, {MANY} moving markers", columns, [Group("", rows)], notes)
