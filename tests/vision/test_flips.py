"""The decision between two poses, over time."""

from __future__ import annotations

import numpy as np

from roverlink.vision.markers.flips import Flips
from roverlink.vision.poses.pnp import Solution
from roverlink.vision.poses.pose import Pose, rotation_of

FRAME = 33_000_000
NAMES = ("left", "right")


def solutions(**chi2: float) -> tuple[list[Solution], list[str]]:
    """Solutions that lean to the left or the right, best first, with their names."""
    names = sorted(chi2, key=lambda name: chi2[name])
    lean = {"left": -0.5, "right": 0.5, "front": 0.0}
    poses = {name: Pose(rotation_of(np.array([0, lean[name], 0])), np.array([0, 0, 1.0])) for name in names}
    return [Solution(poses[name], np.eye(6), chi2[name], 1e-5) for name in names], names


def decide(flips: Flips, frame: int, **chi2: float) -> str:
    """The name of what was decided."""
    found, names = solutions(**chi2)
    return names[flips.decide(found, frame * FRAME)]


def test_the_better_fit_is_taken_first() -> None:
    """Without earlier frames there is nothing else to go by."""
    assert decide(Flips(), 0, left=1.0, right=4.0) == "left"


def test_one_frame_does_not_turn_over_what_many_said() -> None:
    """Noise that favours the other pose for a moment changes nothing."""
    flips = Flips()
    for frame in range(10):
        assert decide(flips, frame, left=1.0, right=6.0) == "left"
    assert decide(flips, 10, left=6.0, right=1.0) == "left"


def test_a_wrong_first_decision_is_taken_back() -> None:
    """When the frames go on to favour the other pose, it is taken."""
    flips = Flips()
    assert decide(flips, 0, left=1.0, right=3.0) == "left"
    assert [decide(flips, frame, left=5.0, right=1.0) for frame in range(1, 9)][-1] == "right"


def test_frontal_views_have_one_pose_and_do_not_disturb() -> None:
    """Where both poses are one, that is taken, whatever was before."""
    flips = Flips()
    decide(flips, 0, left=1.0, right=6.0)
    assert decide(flips, 1, front=1.0) == "front"
    assert decide(flips, 2, left=1.0, right=2.0) == "left"


def test_a_marker_that_was_gone_for_long_is_decided_anew() -> None:
    """What was seen seconds ago says nothing."""
    flips = Flips()
    for frame in range(10):
        decide(flips, frame, left=1.0, right=9.0)
    assert decide(flips, 300, left=4.0, right=1.0) == "right"
