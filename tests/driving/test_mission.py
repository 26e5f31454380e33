"""Missions of the simulated rover: from paths to the wheels, and from what the sensors see back to the pose."""

from __future__ import annotations

import math
import random
from contextlib import ExitStack

import pytest
from needs import NO_GTSAM, NO_OPENCV

pytest.importorskip("gtsam", reason=NO_GTSAM)
pytest.importorskip("cv2", reason=NO_OPENCV)

from tests.driving.mission import GOALS, Mission

_LONGEST_S = 300.0
_NEAR_M = 0.3


def _drive(seed: int) -> list[float]:
    """Drive a mission with slip, lost datagrams and a landmark that somebody has moved; return the distances."""
    chance = random.Random(seed)  # noqa: S311  # repeatable, not secret
    way, direction = chance.uniform(0.5, 1), chance.uniform(0, 2 * math.pi)
    moved = {chance.choice((7, 8, 9, 10)): (way * math.cos(direction), way * math.sin(direction))}
    with ExitStack() as stack:
        mission = Mission(seed, stack, moved, lost=0.05)
        distances = mission.run(_LONGEST_S)
        x, y = mission.localizations[-1]
        assert math.dist((x, y), GOALS[-1]) < _NEAR_M  # the basestation knows where the rover is
    return distances


def test_a_mission_reaches_its_goals() -> None:
    """The rover finds the landmark that was moved, and ends within 30 cm of each of four goals."""
    distances = _drive(1)
    assert len(distances) == len(GOALS)
    assert max(distances) < _NEAR_M


@pytest.mark.slow
def test_twenty_missions_reach_their_goals() -> None:
    """Each one ends within 30 cm of each goal."""
    missions = {seed: _drive(seed) for seed in range(20)}
    print(f"largest distance to a goal: {max(max(distances) for distances in missions.values()):.3f} m")
    assert {seed: one for seed, one in missions.items() if len(one) < len(GOALS) or max(one) >= _NEAR_M} == {}
