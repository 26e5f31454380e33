"""Decides over time which of two poses a marker has.

A flat square seen from afar looks nearly the same at two poses. One frame may not tell; but only the true pose goes on
fitting from frame to frame. Both are followed, each with its misfit so far, which is forgotten slowly.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from roverlink.vision.poses.pnp import Solution
from roverlink.vision.poses.pose import Pose

FORGETTING_S = 0.3
"""After so long a misfit counts for a third."""
JUMP = 6.0
"""What it costs to be a pose that was not there in the frame before, in chi squared."""
LARGEST = 25.0
"""No single frame counts for more, in chi squared."""


class Flips:
    """The two poses of one landmark. They are told apart by how little each turns from frame to frame."""

    def __init__(self) -> None:
        self._followed: list[tuple[Pose, float]] = []
        self._stamp = 0

    def decide(self, solutions: Sequence[Solution], stamp: int) -> int:
        """Which of the solutions, at most two and best first, is the pose; `stamp` in nanoseconds."""
        kept = math.exp(-max(stamp - self._stamp, 0) / 1e9 / FORGETTING_S)
        before = [(pose, misfit * kept) for pose, misfit in self._inherited(solutions)]
        misfits = [old + min(one.chi2 - solutions[0].chi2, LARGEST) for one, (_, old) in zip(solutions, before)]
        least = min(misfits)
        self._followed = [(one.pose, misfit - least) for one, misfit in zip(solutions, misfits)]
        self._stamp = stamp
        return misfits.index(least)

    def _inherited(self, solutions: Sequence[Solution]) -> list[tuple[Pose, float]]:
        """For each solution the pose that it continues, with that pose's misfit."""
        if not self._followed:
            return [(one.pose, 0.0) for one in solutions]
        if len(self._followed) == 1 or len(solutions) == 1:
            pose, misfit = self._followed[0]
            nearest = min(range(len(solutions)), key=lambda index: solutions[index].pose.angle_to(pose))
            if len(solutions) == 1:
                return [(solutions[0].pose, 0.0)]
            return [(pose, misfit if index == nearest else misfit + JUMP) for index in range(len(solutions))]
        first, second = self._followed
        straight = solutions[0].pose.angle_to(first[0]) + solutions[1].pose.angle_to(second[0])
        crossed = solutions[0].pose.angle_to(second[0]) + solutions[1].pose.angle_to(first[0])
        return [first, second] if straight <= crossed else [second, first]
