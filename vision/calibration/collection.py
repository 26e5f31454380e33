"""Collects views of a board while somebody moves it: takes those that add something, and knows what is missing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from roverlink.vision.calibration.board import CharucoBoard
from roverlink.vision.calibration.coverage import Coverage, Need, Traits, traits
from roverlink.vision.calibration.start import rough_camera, rough_pose
from roverlink.vision.calibration.views import BoardDetector, View
from roverlink.vision.camera.camera_model import CameraParameters
from roverlink.vision.markers.detection import Image

VIEWS = 20
"""Views after which a collection may be complete."""
STILL = 0.0025
"""Widths of the image that corners may move from frame to frame in a view that is taken: faster ones are blurred."""
FRAME_NS = 500_000_000
"""Longest time between two frames of which the later tells whether the board is still."""
ELSEWHERE = 0.03
"""Widths of the image that some corner of a view must have moved from where it is in every view that was taken."""


@dataclass(frozen=True, slots=True, eq=False)
class Offer:
    """What became of a frame."""

    view: View
    """The corners that were seen; maybe none."""
    taken: bool
    reason: str
    """Why it was taken, or why not, in words for the user."""
    adds: tuple[Need, ...] = ()
    """The needs that the view serves, where its board could be judged."""
    traits: Traits | None = None


class Collection:
    """The views so far. No input, no output, no clock: frames come in, and the questions are answered."""

    def __init__(self, board: CharucoBoard, wanted: int = VIEWS) -> None:
        self.board = board
        self.wanted = wanted
        self._detector = BoardDetector(board)
        self._views: list[View] = []
        self._camera: CameraParameters | None = None
        self._coverage = Coverage()
        self._before: View | None = None

    @property
    def views(self) -> tuple[View, ...]:
        """The views that were taken."""
        return tuple(self._views)

    @property
    def coverage(self) -> Coverage:
        """What they cover."""
        return self._coverage

    @property
    def missing(self) -> tuple[Need, ...]:
        """Which parts of the image, distances and tilts still need views."""
        return self._coverage.missing()

    @property
    def complete(self) -> bool:
        """Whether there are enough views and nothing is missing."""
        return len(self._views) >= self.wanted and not self.missing

    def offer(self, image: Image, stamp_ns: int, name: str = "") -> Offer:
        """Look at a frame of a stream, grey (H, W) or in colours (H, W, 3).

        It is taken if the board is still and the view adds something.
        """
        return self._consider(self._detector.find(image, name, stamp_ns), force=False)

    def take(self, image: Image, stamp_ns: int, name: str = "") -> Offer:
        """Look at an image and take it if it can be used at all: somebody chose it."""
        return self._consider(self._detector.find(image, name, stamp_ns), force=True)

    def discard(self, view: View) -> None:
        """Take a view out again."""
        self._views = [one for one in self._views if one is not view]
        self._count()

    def _consider(self, view: View, *, force: bool) -> Offer:
        before, self._before = self._before, view
        if reason := self._unusable(view):
            return Offer(view, False, reason)
        seen = self._traits(view)
        adds = tuple(self._coverage.adds(seen))
        if not force and (reason := self._unwanted(view, before, adds)):
            return Offer(view, False, reason, adds, seen)
        self._views.append(view)
        self._count()
        return Offer(view, True, _because(adds), adds, seen)

    def _unusable(self, view: View) -> str:
        if self._views and view.size != self._views[0].size:
            width, height = self._views[0].size
            return f"the image is {view.size[0]}x{view.size[1]}, and the views so far are {width}x{height}"
        return view.flaw

    def _unwanted(self, view: View, before: View | None, adds: Sequence[Need]) -> str:
        if before is None or view.stamp_ns - before.stamp_ns > FRAME_NS or _shift(view, before) > STILL:
            return "hold still"
        if any(_shift(view, taken) < ELSEWHERE for taken in self._views):
            return "seen already: move or tilt the board"
        if not adds and len(self._views) >= self.wanted:
            return "adds nothing that is missing"
        return ""

    def _traits(self, view: View) -> Traits:
        camera = self._camera or rough_camera([view], self.board)
        pose, _ = rough_pose(view, self.board, camera)
        return traits(view, pose, camera.project(pose.apply(self.board.outline)))

    def _count(self) -> None:
        """Judge all views anew, by what they say of the camera together."""
        self._camera = rough_camera(self._views, self.board) if self._views else None
        self._coverage = Coverage()
        for view in self._views:
            self._coverage.add(self._traits(view))


def _shift(view: View, other: View) -> float:
    """How far the corners that both have moved at most, in widths of the image; infinite where there are none."""
    _, here, there = np.intersect1d(view.ids, other.ids, assume_unique=True, return_indices=True)
    if not here.size:
        return np.inf
    moved = np.linalg.norm(view.corners[here] - other.corners[there], axis=1)
    return float(np.max(moved)) / view.size[0]


def _because(adds: Sequence[Need]) -> str:
    names = dict.fromkeys(need.name for need in adds)
    return f"adds {', '.join(names)}" if names else "one more view"
