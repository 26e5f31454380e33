"""Choice between the two possible poses of a flat marker, from several frames.

A small or distant marker looks nearly the same in two poses, so one frame may not decide between them. But only the
true pose fits in every frame. Both poses are followed from frame to frame. The misfit of each is summed, and old
misfits lose their weight slowly.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from roverkit.vision.poses.pnp import Solution
from roverkit.vision.poses.pose import Pose

# How often one frame is wrong depends on the corners. Of 60 rendered poses at 32 px, the better fit was the wrong pose
# in 28 percent with OpenCV's corners, in 17 with SUBPIX, in 7 with APRILTAG and in none with the edge fit. A marker
# that is smaller, blurred or partly covered brings the doubt back.
FORGETTING_S = 0.3
"""Time constant of the misfit's decay in seconds: after this time a misfit counts for a third."""
JUMP = 6.0
"""Misfit, in chi squared, with which a pose starts that was absent in the previous frame."""
LARGEST = 25.0
"""Largest misfit, in chi squared, that a single frame can add to a pose."""


class Flips:
    """Choice between the two possible poses of one landmark (marker or board), frame by frame.

    A pose of a new frame continues that pose of the last frame from which it differs by the smaller rotation. It
    inherits the misfit of that pose: the sum of how badly it fitted in the earlier frames.
    """

    def __init__(self) -> None:
        self._followed: list[tuple[Pose, float]] = []
        self._stamp = 0
        self._frames = 0.0  # number of frames in the misfits; it decays as they do

    def weigh(self, solutions: Sequence[Solution], stamp: int) -> list[float]:
        """Return the probability of each pose, among at most two solutions, best fit first.

        `stamp` is the time of the frame in nanoseconds. The probability follows from the mean of the misfits, while
        their sum decides which pose is more probable: what distorts the corners of a marker, such as bent paper or a
        shadow, stays from frame to frame, so another frame is no new evidence.
        """
        kept = math.exp(-max(stamp - self._stamp, 0) / 1e9 / FORGETTING_S)
        self._frames = 1 + kept * self._frames
        before = [(pose, misfit * kept) for pose, misfit in self._inherited(solutions)]
        # Relative to the best solution, so that noise common to both cancels.
        misfits = [
            old + min(solution.chi2 - solutions[0].chi2, LARGEST) for solution, (_, old) in zip(solutions, before)
        ]
        least = min(misfits)
        self._followed = [(solution.pose, misfit - least) for solution, misfit in zip(solutions, misfits)]
        self._stamp = stamp
        weights = [math.exp((least - misfit) / self._frames / 2) for misfit in misfits]
        return [weight / sum(weights) for weight in weights]

    def _inherited(self, solutions: Sequence[Solution]) -> list[tuple[Pose, float]]:
        """Return, for each solution, the pose of the last frame that it continues, and the misfit of that pose."""
        if not self._followed:
            return [(solution.pose, 0.0) for solution in solutions]
        # One solution became two: the new one starts with a penalty, so that it has to fit
        # better for some frames before it wins.
        if len(self._followed) == 1 or len(solutions) == 1:
            pose, misfit = self._followed[0]
            nearest = min(range(len(solutions)), key=lambda index: solutions[index].pose.angle_to(pose))
            if len(solutions) == 1:
                return [(solutions[0].pose, 0.0)]
            return [(pose, misfit if index == nearest else misfit + JUMP) for index in range(len(solutions))]
        first, second = self._followed
        # Of both pairings, that with the smaller sum of squared differences of the rotations.
        apart = solutions[0].pose.rotation - solutions[1].pose.rotation
        straight = np.vdot(apart, first[0].rotation - second[0].rotation) >= 0
        return [first, second] if straight else [second, first]
