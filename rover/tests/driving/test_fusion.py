"""The fusion of odometry, landmarks and GPS: its topics, accuracy and covariance, and a landmark that was moved."""

from __future__ import annotations

import logging
import math
import random
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import Any

import numpy as np
import pytest
from needs import NO_GTSAM, NO_OPENCV

pytest.importorskip("cv2", reason=NO_OPENCV)
pytest.importorskip("gtsam", reason=NO_GTSAM)

from roverkit.driving.arcs import PlanarPose

from rover.tests.driving.field_drive import FieldDrive
from rover.tests.programs.node_in_memory import hear
from roverlink.runtime.convert.rotations import angles
from roverlink.runtime.interfaces import sensor_msgs, vision_msgs
from roverlink.runtime.interfaces.diagnostic_msgs import DiagnosticArray
from roverlink.runtime.interfaces.nav_msgs import Odometry

_LOGGER = logging.getLogger("fusion")
Told = Callable[[], list[str]]


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


@pytest.fixture
def told(caplog: pytest.LogCaptureFixture) -> Told:
    """Lines that a fusion with the logger of these tests has logged up to now."""
    caplog.set_level(logging.INFO, _LOGGER.name)
    return lambda: [record.getMessage() for record in caplog.records]


def _rover(seed: int, stack: ExitStack, metres: float, **options: Any) -> FieldDrive:
    """A rover that has stood for two seconds, and then driven."""
    rover = FieldDrive(seed, stack, **options)
    rover.stand(2)
    rover.drive(metres)
    return rover


@pytest.mark.slow
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


@pytest.mark.slow
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


@pytest.mark.slow
def test_a_landmark_that_was_moved_is_found_and_named(stack: ExitStack, told: Told) -> None:
    """It is the first one that the rover sees. There is no pose until two others agree, and then it is right."""
    rover = FieldDrive(2, stack, {7: (0.5, 0.3)}, logger=_LOGGER)
    rover.stand(2)
    assert not rover.fused
    rover.drive(15)
    assert _distance(rover.error) < 0.15
    *_, why, _, last = told()
    assert why.startswith("no pose for 10 s: 2 landmarks must agree with the survey")
    assert last.startswith("landmark 7 is not used: it stands 0.")
    assert 0.45 < float(last.split("stands ")[1].split(" m")[0]) < 0.75


class _Misread:
    """Sightings that get the number 9: the first one after two seconds, and a part of the later ones."""

    def __init__(self, part: float) -> None:
        self._part, self._random = part, random.Random(1)  # noqa: S311  # repeatable, not secret
        self._first = True

    def __call__(self, message: Any, now: float) -> None:
        if isinstance(message, vision_msgs.Detection3DArray) and now > 2:
            for one in message.detections:
                if self._first or self._random.random() < self._part:
                    self._first = False
                    one.id = one.results[0].hypothesis.class_id = "9"


def _no_latitude(message: Any, now: float) -> None:
    if isinstance(message, sensor_msgs.NavSatFix) and 6 < now < 8:
        message.latitude = math.nan


def _jump(message: Any, now: float) -> None:
    if isinstance(message, sensor_msgs.NavSatFix) and 6 < now < 12:
        message.latitude += 3e-4


def _unknown_covariance(message: Any, _: float) -> None:
    if isinstance(message, Odometry):
        message.pose.covariance = message.twist.covariance = [0.0] * 36


def _constant_covariance(message: Any, _: float) -> None:
    if isinstance(message, Odometry):
        message.pose.covariance = message.twist.covariance = np.diag([1e-3] * 6).ravel().tolist()


class _Impossible:
    """Numbers that are finite and too large, in each seventh message."""

    def __init__(self) -> None:
        self._count = 0

    def __call__(self, message: Any, now: float) -> None:
        self._count += 1
        if now < 6 or self._count % 7:
            return
        large = (1e300, -1e160, 1e30)[self._count // 7 % 3]
        if isinstance(message, Odometry):
            if message.header.stamp.nanosec % 10**8 == 0:  # the newest one of a step, which the test needs
                return
            message.pose.pose.position.x = message.twist.twist.linear.x = large
        elif isinstance(message, sensor_msgs.NavSatFix):
            message.latitude = message.longitude = large
        else:
            for one in message.detections:
                one.results[0].pose.pose.position.y = large


_FAULTS = {
    "a wrong number": (_Misread(0.0), "sighting of landmark 9 left out"),
    "wrong numbers": (_Misread(0.05), "sighting of landmark 9 left out"),
    "no latitude": (_no_latitude, "GPS position left out: it has no position"),
    "a jump of GPS": (_jump, "GPS position left out: it does not fit the pose"),
    "no covariance": (_unknown_covariance, "odometry without covariance"),
    "a constant covariance": (_constant_covariance, "odometry without covariance, or with one that never grows"),
    "impossible numbers": (_Impossible(), ""),
}


@pytest.mark.slow
@pytest.mark.parametrize(("fault", "said"), _FAULTS.values(), ids=_FAULTS.keys())
def test_a_fault_is_left_out_and_said(stack: ExitStack, told: Told, fault: Any, said: str) -> None:
    """The pose stays within 0.1 m, no landmark is blamed, and the log names the cause."""
    rover = _rover(3, stack, 6, gps=True, change=fault, logger=_LOGGER)
    for _ in range(8):
        rover.drive(1)
        assert rover.is_current
        assert _distance(rover.error) < 0.1
    assert told()
    assert all(one.startswith(said) for one in told())


@pytest.mark.slow
def test_a_landmark_that_is_moved_after_it_was_seen_is_dropped(stack: ExitStack, told: Told) -> None:
    """Its first sightings are left out; as soon as several agree, it is named."""
    rover = _rover(3, stack, 9, logger=_LOGGER)
    rover.move_landmark(8, 0.6, 0.0)
    for _ in range(14):
        rover.drive(1)
        assert _distance(rover.error) < 0.15
    first, last = told()
    assert first.startswith("sighting of landmark 8 left out")
    assert last.startswith("landmark 8 is not used: it stands 0.")


@pytest.mark.slow
def test_a_rover_that_was_pushed_goes_on_from_a_less_certain_pose(stack: ExitStack, told: Told) -> None:
    """There is always a pose, and sightings of two landmarks that fit no more correct it."""
    rover = _rover(3, stack, 9, logger=_LOGGER)
    rover.model.pose = rover.model.pose @ PlanarPose(0.0, 1.0, 0.1)
    rover.drive(14, lambda: None if rover.is_current else pytest.fail("no pose"))
    assert _distance(rover.error) < 0.15
    assert _squared(*rover.error) < 16.3  # exceeded once in a thousand cases
    assert any(one.startswith("no landmark fits any more") for one in told())


def _ahead(message: Any, _: float) -> None:
    if isinstance(message, vision_msgs.Detection3DArray):
        message.header.stamp.sec += 5


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "why"),
    [
        ({"change": _ahead}, "landmarks left out: the stamp is in the future"),
        ({"gps": True, "sees": False}, "no landmark of the survey has been seen; GPS alone"),
        ({"odometry": False}, "no odometry comes on /odometry/wheel"),
    ],
)
def test_no_pose_has_a_reason(stack: ExitStack, told: Told, options: dict[str, Any], why: str) -> None:
    """After ten seconds, the log says it, once."""
    rover = FieldDrive(4, stack, **options, logger=_LOGGER)
    rover.stand(9)
    assert not any("no pose" in one for one in told())
    rover.stand(4)
    (reason,) = [one for one in told() if one.startswith("no pose for 1")]
    assert why in reason
    heard = hear(rover.middleware, "/diagnostics", DiagnosticArray)
    rover.stand(1)
    (status,) = heard[-1].status
    assert why.partition(":")[0] in f"{status.message} {status.values}"


@pytest.mark.parametrize(
    ("seeds", "least", "most"),
    [pytest.param([1], 0, 6, marks=pytest.mark.slow), pytest.param(range(4), 2, 4, marks=pytest.mark.exhaustive)],
)
def test_gps_limits_the_error_while_no_landmark_is_seen(
    stack: ExitStack, seeds: list[int], least: float, most: float
) -> None:
    """The position is less uncertain than without GPS, and fits its covariance; the errors of one drive are alike."""
    squared: list[float] = []
    for seed in seeds:
        spread = {}
        for gps in (False, True):
            rover = FieldDrive(seed, stack, gps=gps)
            rover.stand(10)
            rover.drive(10)
            rover.sees = False
            rover.drive(40, lambda: squared.append(_squared(*rover.error)) if gps else None)  # noqa: B023  # called now
            spread[gps] = float(np.trace(rover.error[1][:2, :2]))
            stack.close()
        assert spread[True] < spread[False]
    assert least < np.mean(squared) < most


@pytest.mark.slow
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
