"""Collection of views for a calibration while somebody moves the board.

A view is the set of board corners found in one image. The collection takes the useful views, and tells which parts of
the image, distances and tilts of the board still need views.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from roverkit.calibration.board import CalibrationBoard
from roverkit.calibration.coverage import Coverage, Need, Traits, traits
from roverkit.calibration.start import rough_camera, rough_pose
from roverkit.calibration.views import BoardDetector, View
from roverkit.vision.camera.camera_model import CameraParameters
from roverkit.vision.markers.detection import Image

VIEWS = 20
"""Default of the least number of views in a complete collection."""
STILL = 0.0025
"""Largest motion of a corner between two frames, as a fraction of the image width, at which the board counts as still.

Faster motion blurs the corners, so such a view is not taken.
"""
FRAME_NS = 500_000_000
"""Longest time in nanoseconds between two frames that are compared to find out if the board is still."""
ELSEWHERE = 0.03
"""Distance by which a new view must differ from each view that was taken, as a fraction of the image width.

At least one corner must have moved so far. Otherwise the new view shows the same as the old one.
"""


@dataclass(frozen=True, slots=True, eq=False)
class Offer:
    """Result of the examination of one frame: the view in it, and the reason why the view was taken or not."""

    view: View
    """Corners found in the frame, possibly none."""
    taken: bool
    reason: str
    """Reason why the view was taken or not, in words for the user, such as ``hold the board still``."""
    adds: tuple[Need, ...] = ()
    """Requirements that are not met yet and that the view helps to meet; empty for an unusable view."""
    traits: Traits | None = None
    """Properties of the view that count for the coverage; None for an unusable view."""


class Collection:
    """Collection of views for a calibration. It has no input, output or clock; the caller passes frames to it.

    `wanted` is the least number of views in a complete collection.
    """

    def __init__(self, board: CalibrationBoard, wanted: int = VIEWS) -> None:
        self.board = board
        self.wanted = wanted
        self._detector = BoardDetector(board)
        self._views: list[View] = []
        self._camera: CameraParameters | None = None
        self._coverage = Coverage()
        self._before: View | None = None

    @property
    def views(self) -> tuple[View, ...]:
        """Views that were taken, oldest first."""
        return tuple(self._views)

    @property
    def coverage(self) -> Coverage:
        """Parts of the image, distances and tilts that the taken views show."""
        return self._coverage

    @property
    def missing(self) -> tuple[Need, ...]:
        """Parts of the image, distances and tilts that still need views."""
        return self._coverage.missing()

    @property
    def complete(self) -> bool:
        """True if there are enough views and nothing is missing."""
        return len(self._views) >= self.wanted and not self.missing

    def offer(self, image: Image, stamp_ns: int, name: str = "") -> Offer:
        """Examine a frame of a stream, grey (H, W) or BGR (H, W, 3).

        The view in the frame is taken if the board is still, and if the view shows something that the taken views do
        not show.
        """
        return self._consider(self._detector.find(image, name, stamp_ns), force=False)

    def take(self, image: Image, stamp_ns: int, name: str = "") -> Offer:
        """Examine an image that the user has chosen, and take the view in it if the view is usable."""
        return self._consider(self._detector.find(image, name, stamp_ns), force=True)

    def discard(self, view: View) -> None:
        """Remove a view that was taken, and compute the coverage without it."""
        self._views = [taken for taken in self._views if taken is not view]
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
            return f"the image has {view.size[0]}x{view.size[1]} pixels, but the other views have {width}x{height}"
        return view.flaw

    def _unwanted(self, view: View, before: View | None, adds: Sequence[Need]) -> str:
        if before is None or view.stamp_ns - before.stamp_ns > FRAME_NS or _shift(view, before) > STILL:
            return "hold the board still"
        if any(_shift(view, taken) < ELSEWHERE for taken in self._views):
            return "same as a view taken before: move or tilt the board"
        if not adds and len(self._views) >= self.wanted:
            return "adds nothing new: the views taken before show the same parts, distances and tilts"
        return ""

    def _traits(self, view: View) -> Traits:
        # Before the first view is taken there is no camera yet; a rough one is good enough to judge tilt and distance.
        camera = self._camera or rough_camera([view], self.board)
        pose, _ = rough_pose(view, self.board, camera)
        return traits(view, pose, camera.project(pose.apply(self.board.outline)))

    def _count(self) -> None:
        """Compute the rough camera and the coverage again from all views that were taken."""
        self._camera = rough_camera(self._views, self.board) if self._views else None
        self._coverage = Coverage()
        for view in self._views:
            self._coverage.add(self._traits(view))


def _shift(view: View, other: View) -> float:
    """Return the largest distance that a corner moved between two views, as a fraction of the image width.

    Returns infinity if no corner is in both views.
    """
    _, here, there = np.intersect1d(view.ids, other.ids, assume_unique=True, return_indices=True)
    if not here.size:
        return np.inf
    moved = np.linalg.norm(view.corners[here] - other.corners[there], axis=1)
    return float(np.max(moved)) / view.size[0]


def _because(adds: Sequence[Need]) -> str:
    names = dict.fromkeys(need.name for need in adds)
    return f"adds {', '.join(names)}" if names else "one more view"
