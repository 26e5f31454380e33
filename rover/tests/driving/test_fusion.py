"""The fusion of odometry, landmarks and GPS: its topics, accuracy and covariance, and a landmark that was moved."""

from __future__ import annotations

import logging
import math
from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

import numpy as np
import pytest
from needs import NO_GTSAM, NO_OPENCV

pytest.importorskip("cv2", reason=NO_OPENCV)
pytest.importorskip("gtsam", reason=NO_GTSAM)

from roverkit.driving.arcs import PlanarPose

from rover.tests.driving.field_drive import FieldDrive
from roverlink.runtime.convert.rotations import angles


def _distance(known: tuple[np.ndarray, np.ndarray]) -> float:
    """The distance in metres of a position from the true one; ``known`` has the error and the covariance of a pose."""
    return math.hypot(*known[0][:2])


def _squared(error: np.ndarray, covariance: np.ndarray) -> float:
    """The normalized estimation error squared (NEES): chi squared with 3 degrees of freedom."""
    return float(error @ np.linalg.solve(covariance, error))


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


def _rover(seed: int, stack: ExitStack, metres: float, **options: Any) -> FieldDrive:
    """A rover that has stood for two seconds, and then driven."""
    rover = FieldDrive(seed, stack, **options)
    rover.stand(2)
    rover.drive(metres)
    return rover


def test_the_fused_pose_is_better_than_the_odometry_and_knows_how_good_it_is(stack: ExitStack) -> None:
    """Over 26 m with slip, its error fits the covariance; map to odom leads from the odometry to it (REP 105)."""
    rover = _rover(3, stack, 6)  # past two landmarks
    errors, squared, alone = [], [], []
    for _ in range(20):
        rover.drive(1)
        assert rover.is_current
        errors.append(_distance(rover.error))
        squared.append(_squared(*rover.error))
        alone.append(_distance(rover.odometry_error))
    assert np.sqrt(np.mean(np.square(errors))) < 0.05
    assert np.mean(alone[-5:]) > 2 * np.mean(errors[-5:])
    assert np.mean(squared) < 6
    shift, message = rover.shifts[-1], rover.fused[-1]
    assert (shift.header.frame_id, shift.child_frame_id) == ("map", "odom")
    assert (message.header.frame_id, message.child_frame_id) == ("map", "base_link")
    assert shift.header.stamp == message.header.stamp
    way, turn = shift.transform.translation, angles(shift.transform.rotation)[2]
    assert rover.by_odometry is not None
    whole = PlanarPose(way.x, way.y, turn) @ rover.by_odometry.pose
    place = message.pose.pose
    assert (whole.x, whole.y) == pytest.approx((place.position.x, place.position.y))
    assert math.remainder(whole.yaw - angles(place.orientation)[2], 2 * math.pi) == pytest.approx(0, abs=1e-9)
    assert message.twist.twist.linear.x == pytest.approx(rover.model.speed, abs=0.1)


def test_without_landmarks_the_covariance_grows_as_the_error_may(stack: ExitStack) -> None:
    """While the camera sees nothing, the pose goes on with the odometry, and a landmark corrects it again."""
    rover = _rover(5, stack, 8)
    seeing = rover.error[1]
    rover.sees = False
    rover.drive(10)
    assert rover.is_current
    error, blind = rover.error
    assert blind[0, 0] > 4 * seeing[0, 0]
    assert _squared(error, blind) < 16.3  # exceeded once in a thousand cases
    rover.sees = True
    rover.drive(8)
    assert rover.error[1][0, 0] < blind[0, 0] / 2


def test_a_landmark_that_was_moved_is_found_and_named(stack: ExitStack, caplog: pytest.LogCaptureFixture) -> None:
    """It is the first one that the rover sees. There is no pose until two others agree, and then it is right."""
    logger = logging.getLogger("fusion")
    with caplog.at_level(logging.INFO, logger="fusion"):
        rover = FieldDrive(2, stack, {7: (0.5, 0.3)}, logger=logger)
        rover.stand(2)
        assert not rover.fused
        rover.drive(15)
    assert _distance(rover.error) < 0.15
    (told,) = {record.getMessage() for record in caplog.records}
    assert told.startswith("landmark 7 is not used: it stands 0.")
    assert 0.45 < float(told.split("stands ")[1].split(" m")[0]) < 0.75


@pytest.mark.slow
def test_gps_limits_the_error_while_no_landmark_is_seen(stack: ExitStack) -> None:
    """With GPS, the position after 25 m without landmarks is less uncertain than without, and fits its covariance."""
    spread = {}
    for gps in (False, True):
        rover = _rover(4, stack, 8, gps=gps)
        rover.sees = False
        rover.drive(25)
        error, covariance = rover.error
        spread[gps] = float(np.trace(covariance[:2, :2]))
        assert _squared(error, covariance) < 16.3
        stack.close()
    assert spread[True] < 0.7 * spread[False]


def test_a_simulation_that_begins_again_begins_the_fusion_again(stack: ExitStack) -> None:
    """After the time has jumped back, poses come from what is seen since then."""
    rover = _rover(6, stack, 6)
    first = len(rover.fused)
    rover.stamp -= 20 * 10**9
    rover.sees = False
    rover.stand(1)
    assert len(rover.fused) == first
    rover.sees = True
    rover.drive(10)
    assert rover.is_current
    assert _distance(rover.error) < 0.2
