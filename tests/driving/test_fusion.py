"""The fusion of odometry, landmarks and GPS: its topics, accuracy and covariance, and a landmark that was moved."""

from __future__ import annotations

import logging
import math
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from needs import NO_GTSAM, NO_OPENCV

pytest.importorskip("cv2", reason=NO_OPENCV)
pytest.importorskip("gtsam", reason=NO_GTSAM)

from roverlink.demo.field import AHEAD, HEIGHT_M, SIDE, parameters
from roverlink.driving.arcs import PlanarPose
from roverlink.runtime.convert.rotations import angles
from roverlink.runtime.interfaces import vision_msgs
from roverlink.simulation.rover_camera import FRAME, RoverCamera
from roverlink.vision import MarkerSet, Pose, TargetId, Tracker
from roverlink.vision.ros.sighting_messages import FrameNames, detections_of
from tests.driving.field_drive import FieldDrive
from tests.driving.simulated_tracker import field, standing, write_landmarks

_HIGH = 9.348
"""Chi squared with 3 degrees of freedom that is exceeded in 2.5 % of all cases."""
_MEAN = (2.54, 3.50)
"""Interval that holds its mean over a hundred cases with a probability of 95 %."""


class RenderedTracker:
    """The tracker of `roverlink aruco track`, with the rendered images of a camera that looks ahead."""

    mount = Pose(AHEAD, np.array([0.0, 0.0, HEIGHT_M]))

    def __init__(self, seed: int, folder: Path, places: Mapping[TargetId, Pose]) -> None:
        """Stand the landmarks at their places, which are written to a file in the folder."""
        path = folder / "standing.yaml"
        write_landmarks(path, places)
        self._camera = RoverCamera(path, seed)
        self._tracker = Tracker(parameters(), MarkerSet(side=SIDE))

    def see(self, rover: PlanarPose, stamp: int) -> vision_msgs.Detection3DArray:
        """Return the message about an image that is taken at a pose of the rover."""
        image = np.repeat(self._camera.image(rover)[:, :, None], 3, axis=2)
        return detections_of(self._tracker.track(image, stamp), stamp, FrameNames(FRAME, "aruco_"))


def _distance(known: tuple[np.ndarray, np.ndarray]) -> float:
    """The distance in metres of a position from the true one; ``known`` has the error and the covariance of a pose."""
    return math.hypot(*known[0][:2])


def _squared(known: tuple[np.ndarray, np.ndarray]) -> float:
    """The normalized estimation error squared (NEES): chi squared with 3 degrees of freedom."""
    error, covariance = known
    return float(error @ np.linalg.solve(covariance, error))


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    """Context of the nodes."""
    with ExitStack() as stack:
        yield stack


def _rover(seed: int, stack: ExitStack, metres: float, **options: Any) -> FieldDrive:
    """A rover that has stood for two seconds, and then driven."""
    rover = FieldDrive(seed, stack, **options)
    rover.stand(2)
    rover.drive(metres)
    return rover


def test_the_fused_pose_is_better_than_the_odometry_and_knows_how_good_it_is(stack: ExitStack) -> None:
    """Over 26 m with slip: the error is some centimetres, and it fits the covariance."""
    rover = _rover(3, stack, 6)  # past two landmarks
    errors, squared, alone = [], [], []
    for _ in range(20):
        rover.drive(1)
        assert rover.is_current
        errors.append(_distance(rover.error))
        squared.append(_squared(rover.error))
        alone.append(_distance(rover.odometry_error))
    assert np.sqrt(np.mean(np.square(errors))) < 0.05
    assert np.mean(alone[-5:]) > 2 * np.mean(errors[-5:])
    assert np.mean(squared) < 6


def test_the_transform_from_map_to_odom_leads_to_the_fused_pose(stack: ExitStack) -> None:
    """REP 105: the pose in the frame odom, transformed to map, is the pose on the field. The velocity is passed on."""
    rover = _rover(1, stack, 6)
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
    assert error @ np.linalg.solve(blind, error) < 16.3  # exceeded once in a thousand cases
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
    """With GPS, the position after 60 m without landmarks is less uncertain than without, and fits its covariance."""
    spread = {}
    for gps in (False, True):
        rover = _rover(4, stack, 8, gps=gps)
        rover.sees = False
        rover.drive(60)
        error, covariance = rover.error
        spread[gps] = float(np.trace(covariance[:2, :2]))
        assert error @ np.linalg.solve(covariance, error) < 16.3
        stack.close()
    assert spread[True] < 0.8 * spread[False]


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


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_rendered_images_and_the_tracker_give_the_pose_too(seed: int, stack: ExitStack, tmp_path: Path) -> None:
    """Landmarks in images, with one that was moved: the error stays small over 20 m, and fits the covariance."""
    places = standing(field(), seed, {8: (0.6, 0.4)})
    rover = FieldDrive(seed, stack, tracker=RenderedTracker(seed, tmp_path, places))
    rover.stand(1)
    rover.drive(15)
    errors, squared = [], []
    for _ in range(20):
        rover.drive(0.5)
        errors.append(_distance(rover.error) ** 2)
        squared.append(_squared(rover.error))
    print(f"RMSE {math.sqrt(np.mean(errors)):.3f} m, NEES {np.mean(squared):.2f}")
    assert math.sqrt(np.mean(errors)) < 0.15
    assert np.mean(squared) < 2 * _MEAN[1]  # the errors of one drive depend on each other


@pytest.mark.slow
def test_a_hundred_drives_of_a_hundred_metres() -> None:
    """In each one, the RMSE is at most 5 cm and below that of the odometry, and its covariances fit the errors."""
    figures: dict[str, list[float]] = {name: [] for name in ("rms", "alone", "mean", "final", "final_alone")}
    for seed in range(100):
        with ExitStack() as stack:
            rover = FieldDrive(seed, stack)
            rover.stand(2)
            errors, squared, by_odometry = [], [], []
            while rover.model.rolled < 100:
                rover.drive(0.5)
                if rover.fused:
                    errors.append(_distance(rover.error) ** 2)
                    squared.append(_squared(rover.error))
                    by_odometry.append(_distance(rover.odometry_error) ** 2)
        drive = math.sqrt(np.mean(errors)), math.sqrt(np.mean(by_odometry)), np.mean(squared), squared[-1]
        for values, value in zip(figures.values(), (*drive, _squared(rover.odometry_error)), strict=True):
            values.append(float(value))
    told = ", ".join(f"{name}: mean {np.mean(one):.3f}, largest {max(one):.3f}" for name, one in figures.items())
    print(told)
    assert max(figures["rms"]) <= 0.05, told
    assert np.less(figures["rms"], figures["alone"]).all(), told
    for name in ("final", "mean", "final_alone"):
        assert _MEAN[0] < np.mean(figures[name]) < _MEAN[1], told
    # Of 100 cases, more than 7 are higher with a probability of 0.4 %.
    assert sum(one > _HIGH for one in figures["final"]) <= 7, told
