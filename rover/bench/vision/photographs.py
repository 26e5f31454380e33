"""Section `photographs`: markers on photographs that nobody of this project took, beside plain OpenCV.

Rendered frames share assumptions with the programs that read them; photographs do not. `board/` holds photographs of a
printed board of known geometry, and `room/` photographs with the markers that a person listed. They are not part of the
project, so the section is left out where they are missing.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

import cv2
import numpy as np
from roverkit.vision.camera.camera_model import CameraParameters, Floats
from roverkit.vision.images.rendering import Grey
from roverkit.vision.markers.marker_set import MarkerSet
from roverkit.vision.markers.tracker import Tracker

from bench.result import Group, SectionResult, Table
from rover.bench.vision.contestants import OURS, REFINEMENTS, plain_detector

PHOTOS = Path(__file__).parents[4] / "shared" / "photos"
ROOM, ROOM_TAGS = "room", "DICT_APRILTAG_36h11"
BOARD, BOARD_MARKERS = "board", "DICT_6X6_1000"
_COLUMNS, _ROWS = 4, 5
_SIDE, _PITCH = 0.0425 * 196 / 221, 0.0425  # metres: in the printed file, a marker has 196 pixels and a gap 25
_FRAMES, _ROUNDS, _FRAME_NS = 9, 5, 33_000_000
_APRILTAG_SHIFT = 0.46 if cv2.__version__.startswith("5") else 0.0
"""Shift in pixels of the corners of OpenCV 5.0 with the refinement APRILTAG, along x and y; it is a bug of OpenCV."""

Corners = Mapping[int, Floats]
"""Corners (4, 2) in pixels of each marker in a photograph, by its number."""
Finder = Callable[[Grey], Corners]


@dataclass(frozen=True, slots=True)
class Found:
    """Markers on the photographs of a room: how many a person listed, were found, and were found but not listed."""

    contestant: str
    listed: int
    found: int
    false: int


@dataclass(frozen=True, slots=True)
class Fit:
    """Agreement of the corners of a board with its geometry, after a calibration with the same corners."""

    contestant: str
    markers: int
    rms: float
    """Root mean square distance in pixels between a corner and its place."""


@dataclass(frozen=True, slots=True)
class Cost:
    """CPU time in milliseconds for a frame with all markers of the board.

    It is the mean of some frames; of each frame, the least of some rounds counts, because other load disturbs.
    """

    contestant: str
    milliseconds: float


def measure(say: Callable[[str], None], folder: Path = PHOTOS) -> SectionResult:
    """Measure all contestants on the photographs in a folder."""
    tables, found, fits = list[Table](), list[Found](), list[Fit]()
    if not folder.is_dir():
        say(f"photographs: left out, because the folder {folder} is missing")
        return SectionResult(tables, (), {})
    found = [find(folder / ROOM, name) for name in (OURS, "OpenCV")]
    say("photographs of a room: done")
    fits = [fit(folder / BOARD, name) for name in (OURS, *REFINEMENTS)]
    rows = [[one.contestant, str(one.listed), str(one.found), str(one.false)] for one in found]
    columns = ("", "listed", "found", "not listed")
    tables.append(Table("Markers on photographs of a room, one frame each", columns, [Group("", rows)]))
    rows = [[one.contestant, str(one.markers), f"{one.rms:.3f}"] for one in fits]
    notes = ["RMS of the distances between corners and board, after a calibration with these corners."]
    tables.append(
        Table("Corners on photographs of a printed board", ("", "markers", "RMS px"), [Group("", rows)], notes)
    )
    costs = cost(folder / BOARD)
    rows = [[one.contestant, f"{one.milliseconds:.1f}"] for one in costs]
    notes = ["A photograph with all 20 markers, shaken. roverlink: tracking with poses; OpenCV: detection only."]
    tables.append(Table("CPU time per frame of 20 markers", ("", "ms"), [Group("", rows)], notes))
    values: dict[str, list[Found] | list[Fit] | list[Cost]] = {"room": found, "board": fits, "cost": costs}
    return SectionResult(tables, (), {name: [asdict(one) for one in rows] for name, rows in values.items()})


def find(folder: Path, contestant: str) -> Found:
    """Compare the markers that a contestant finds in the photographs of a folder with those in its `markers.txt`."""
    listed = found = false = 0
    look: Finder | None = None
    for line in (folder / "markers.txt").read_text(encoding="utf-8").splitlines():
        name, *ids = line.split()
        image, there = _photograph(folder / name), set(map(int, ids))
        look = look or finder(contestant, ROOM_TAGS, _guessed(image))
        seen = set(look(image))
        listed, found, false = listed + len(there), found + len(seen & there), false + len(seen - there)
    return Found(contestant, listed, found, false)


def fit(folder: Path, contestant: str, stride: int = 1) -> Fit:
    """Return how well the corners that a contestant finds in photographs of the board agree with its geometry.

    Uses every `stride`-th photograph.
    """
    paths = sorted(folder.glob("*.jpg"))[::stride]
    first = _photograph(paths[0])
    camera = _guessed(first)
    if contestant == OURS:  # a camera is needed before the corners; that of OpenCV's corners is good enough
        rough = finder("OpenCV SUBPIX", BOARD_MARKERS, camera)
        camera = _calibrated([rough(_photograph(path)) for path in paths[::3]], camera)[0]
    look = finder(contestant, BOARD_MARKERS, camera)
    seen = [look(_photograph(path)) for path in paths]
    _, rms = _calibrated(seen, camera)
    return Fit(contestant, sum(len(_on_board(corners)) for corners in seen), rms)


def cost(folder: Path) -> list[Cost]:
    """Measure the CPU time for frames of a shaken photograph on which all markers of the board are seen.

    The contestants take turns, so that other load on the machine affects both alike.
    """
    plain = plain_detector(REFINEMENTS["OpenCV"], getattr(cv2.aruco, BOARD_MARKERS))
    images = map(_photograph, sorted(folder.glob("*.jpg")))
    image = next(one for one in images if len(plain.detectMarkers(one)[0]) == _COLUMNS * _ROWS)
    tracker = Tracker(_guessed(image), MarkerSet(BOARD_MARKERS, side=_SIDE))
    taken = np.zeros((2, _ROUNDS, _FRAMES))
    for turn in range(_ROUNDS):
        tracker.reset()
        for frame in range(_FRAMES):
            shift = np.array([[1, 0, 3 * np.sin(frame / 3)], [0, 1, 2 * np.cos(frame / 4)]])
            shaken = cv2.warpAffine(image, shift, image.shape[::-1], borderMode=cv2.BORDER_REPLICATE)
            start = time.process_time()
            tracker.track(shaken, frame * _FRAME_NS)
            middle = time.process_time()
            plain.detectMarkers(shaken)
            taken[:, turn, frame] = middle - start, time.process_time() - middle
    ours, others = 1e3 * taken[:, :, 2:].min(axis=1).mean(axis=1)  # the first frames find the markers
    return [Cost(OURS, float(ours)), Cost("OpenCV", float(others))]


def finder(contestant: str, dictionary: str, camera: CameraParameters) -> Finder:
    """Return a function that finds markers in single photographs."""
    if contestant == OURS:
        tracker = Tracker(camera, MarkerSet(dictionary, side=_SIDE))

        def ours(image: Grey) -> Corners:
            tracker.reset()
            return {one.id: one.corners for one in tracker.track(image, 0) if isinstance(one.id, int)}

        return ours
    detector = plain_detector(REFINEMENTS[contestant], getattr(cv2.aruco, dictionary))
    shift = _APRILTAG_SHIFT if contestant.endswith("APRILTAG") else 0.0

    def plain(image: Grey) -> Corners:
        corners, numbers, _ = detector.detectMarkers(image)
        found = [] if numbers is None else np.reshape(numbers, -1).tolist()
        return {number: np.reshape(corner, (4, 2)).astype(float) - shift for number, corner in zip(found, corners)}

    return plain


def _photograph(path: Path) -> Grey:
    return np.asarray(cv2.imread(str(path), cv2.IMREAD_GRAYSCALE), np.uint8)


def _guessed(image: Grey) -> CameraParameters:
    height, width = image.shape
    return CameraParameters(
        np.array([[width, 0, width / 2], [0, width, height / 2], [0, 0, 1]]), np.zeros(5), (width, height)
    )


def _on_board(corners: Corners) -> list[int]:
    return [number for number in corners if number < _COLUMNS * _ROWS]


def _calibrated(seen: list[Corners], guess: CameraParameters) -> tuple[CameraParameters, float]:
    """Calibrate with OpenCV; return the camera, and the RMS of the residuals' lengths in pixels."""
    objects, images = [], []
    for corners in seen:
        if numbers := _on_board(corners):
            objects.append(np.concatenate([_place(number) for number in numbers]).astype(np.float32))
            images.append(np.concatenate([corners[number] for number in numbers]).astype(np.float32))
    rms, matrix, distortion, *_ = cv2.calibrateCamera(objects, images, guess.size, None, None)
    return CameraParameters(matrix, np.ravel(distortion)[:5], guess.size), float(rms)


def _place(number: int) -> Floats:
    row, column = divmod(number, _COLUMNS)
    corner = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]) * _SIDE
    return corner + np.array([column, row, 0]) * _PITCH
