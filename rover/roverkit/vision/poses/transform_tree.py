"""Tree of coordinate frames over time, as on ROS 2's topics /tf and /tf_static.

Each frame has one parent. A transform between two frames leads over their common ancestor. Transforms at a time between
two stamps are interpolated; static transforms hold at any time.
"""

from __future__ import annotations

import threading
from bisect import bisect_left, insort
from collections.abc import Iterator
from dataclasses import dataclass, field
from operator import itemgetter

from roverkit.vision.poses.pose import IDENTITY, Pose, angles_of, rotation_of
from roverlink.runtime.core.errors import RoverlinkError, nearest

KEPT_NS = 10_000_000_000
"""Time in nanoseconds for which transforms are kept: ten seconds, as in tf2."""
NEAR_NS = 100_000_000
"""Largest time in nanoseconds between a wanted stamp and the nearest transform, if there is none on one side of it.

A transform of the odometry often arrives after the image whose stamp is later. At 1 m/s, this is an error of 0.1 m.
"""
_LONGEST_WAY = 100  # frames on the way to the root; a longer way is a loop


class TransformError(RoverlinkError):
    """Transform that is not known: frames that are not connected, or a time without transforms."""


@dataclass
class _Link:
    """Transforms from a frame to its parent, by their stamps."""

    parent: str
    static: bool
    stamped: list[tuple[int, Pose]] = field(default_factory=list)

    def add(self, stamp: int, pose: Pose) -> None:
        if self.static:
            self.stamped = [(stamp, pose)]
            return
        if self.stamped and stamp < self.stamped[-1][0] - KEPT_NS:
            self.stamped = []  # the time has begun again, as when a recording is repeated
        place = bisect_left(self.stamped, stamp, key=itemgetter(0))
        if place < len(self.stamped) and self.stamped[place][0] == stamp:
            self.stamped[place] = (stamp, pose)
        else:
            insort(self.stamped, (stamp, pose), key=itemgetter(0))
        oldest = bisect_left(self.stamped, self.stamped[-1][0] - KEPT_NS, key=itemgetter(0))
        del self.stamped[:oldest]

    def at(self, stamp: int) -> Pose | None:
        """Return the transform at a time; None if no transform is near."""
        if self.static:
            return self.stamped[0][1]
        place = bisect_left(self.stamped, stamp, key=itemgetter(0))
        around = self.stamped[max(place - 1, 0) : place + 1]
        if len(around) == 2:
            return _between(around[0], around[1], stamp)
        ((at, pose),) = around
        return pose if abs(at - stamp) <= NEAR_NS else None


class TransformTree:
    """Tree of coordinate frames. Safe to use from several threads."""

    def __init__(self) -> None:
        self._links: dict[str, _Link] = {}
        self._lock = threading.Lock()

    def add(self, parent: str, child: str, stamp: int, pose: Pose, *, static: bool = False) -> None:
        """Add a transform from the frame ``child`` to the frame ``parent``; ``stamp`` is in nanoseconds.

        If the child had another parent, its earlier transforms are forgotten, as in tf2.
        """
        with self._lock:
            link = self._links.get(child)
            if link is None or link.parent != parent or link.static != static:
                link = self._links[child] = _Link(parent, static)
            link.add(stamp, pose)

    def look_up(self, target: str, source: str, stamp: int) -> Pose:
        """Return the transform from the frame ``source`` to the frame ``target`` at a time in nanoseconds.

        Raises `TransformError` if the frames are not connected, or if a transform on the way is not known at this time.
        """
        with self._lock:
            of_source, of_target = ([*self._ancestors(frame)] for frame in (source, target))
            common = next((frame for frame in of_source if frame in of_target), None)
            if common is None:
                raise TransformError(f"no transforms connect {source!r} with {target!r}; {self._known(source, target)}")
            return self._to(common, target, stamp).inverse() @ self._to(common, source, stamp)

    def _ancestors(self, frame: str) -> Iterator[str]:
        """Yield a frame, its parent, and so on."""
        for _ in range(_LONGEST_WAY):
            yield frame
            if frame not in self._links:
                return
            frame = self._links[frame].parent

    def _to(self, ancestor: str, frame: str, stamp: int) -> Pose:
        """Return the transform from a frame to an ancestor of it."""
        pose = IDENTITY
        while frame != ancestor:
            link = self._links[frame]
            step = link.at(stamp)
            if step is None:
                off = (stamp - link.stamped[-1][0]) / 1e9
                when = f"the newest one is {off:.1f} s older" if off > 0 else "the transforms are newer"
                raise TransformError(f"the transform from {frame!r} to {link.parent!r} is not known now: {when}")
            pose, frame = step @ pose, link.parent
        return pose

    def _known(self, *wanted: str) -> str:
        frames = sorted({*self._links, *(link.parent for link in self._links.values())})
        missing = next((frame for frame in wanted if frame not in frames), None)
        if not frames:
            return "no transforms have come"
        return "both are known" if missing is None else f"there is no frame {missing!r}; {nearest(missing, frames)}"


def _between(before: tuple[int, Pose], after: tuple[int, Pose], stamp: int) -> Pose:
    """Return the transform at a time between two others: linear in the translation, and at a constant angular rate."""
    part = (stamp - before[0]) / (after[0] - before[0])
    turn = rotation_of(part * angles_of(after[1].rotation @ before[1].rotation.T))
    translation = (1 - part) * before[1].translation + part * after[1].translation
    return Pose(turn @ before[1].rotation, translation)
