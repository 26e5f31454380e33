"""Geometry of the fusion: motions from odometry, and detections on the plane, for any poses."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from needs import NO_GTSAM, NO_OPENCV

pytest.importorskip("cv2", reason=NO_OPENCV)
pytest.importorskip("gtsam", reason=NO_GTSAM)

from roverkit.driving.arcs import PlanarPose
from roverkit.fusion.field_factors import detection_factor, pose2
from roverkit.fusion.field_graph import FieldGraph
from roverkit.fusion.gtsam_library import gtsam
from roverkit.fusion.landmark_agreement import agreeing
from roverkit.fusion.odometry_track import OdometryPoint, OdometryTrack
from roverkit.fusion.planar_gaussian import PlanarGaussian, adjoint, rotation, squared_distance, squared_way
from roverkit.fusion.planar_landmarks import planar_detections
from roverkit.fusion.slipping_motion import ERRORS, STATES, YawError, slipping_motion, state_of
from roverkit.gating import Reasons, RecentInnovations, gate_limit
from roverkit.vision import Landmark, Landmarks, Pose
from roverkit.vision.poses.pose import quaternion_of, rotation_of

from roverlink.runtime.interfaces import geometry_msgs, vision_msgs
from roverlink.runtime.ros_time.headers import header_of

_metres = st.floats(-20, 20)
_angles = st.floats(-math.pi, math.pi)
_poses = st.builds(PlanarPose, _metres, _metres, _angles)
_covariances = st.lists(st.floats(-0.2, 0.2), min_size=9, max_size=9).map(
    lambda numbers: np.reshape(numbers, (3, 3)) @ np.reshape(numbers, (3, 3)).T + 1e-3 * np.eye(3)
)
_gaussians = st.builds(PlanarGaussian, _poses, _covariances)
_rotations = st.tuples(_angles, _angles, _angles).map(lambda angles: rotation_of(np.array(angles) / 2))


@given(_gaussians, _gaussians, st.floats(0.0, 1.0))
def test_a_motion_is_what_odometry_has_added(start: PlanarGaussian, motion: PlanarGaussian, known: float) -> None:
    """The yaw keeps the variance of the odometry, also if its error is the same before and after the motion."""
    whole, track = start @ motion, OdometryTrack(0.02)
    deviations = [math.sqrt(one.outer_covariance[2, 2]) for one in (start, whole)]
    apart = known * (deviations[1] - deviations[0]) ** 2 + (1 - known) * (deviations[1] ** 2 - deviations[0] ** 2)
    for stamp, place, variance in ((10**9, start, 0.0), (2 * 10**9, whole, apart)):
        track.add(OdometryPoint(stamp, place.pose, place.outer_covariance, variance, speed=100.0))
    before, after = track.at(10**9), track.at(2 * 10**9)
    assert before is not None
    assert after is not None
    found = before.motion_to(after)
    assert (found.pose.x, found.pose.y) == pytest.approx((motion.pose.x, motion.pose.y), abs=1e-9)
    assert math.remainder(found.pose.yaw - motion.pose.yaw, 2 * math.pi) == pytest.approx(0, abs=1e-9)
    assert found.gaussian.covariance[2, 2] == pytest.approx(apart, abs=1e-9)
    assert (np.linalg.eigvalsh(found.covariance) > -1e-9).all()


@given(_gaussians, _gaussians, _angles)
def test_a_direction_that_nobody_has_measured_changes_no_distance(
    one: PlanarGaussian, other: PlanarGaussian, turn: float
) -> None:
    """Whatever is written for it: the gate sees the positions alone."""
    unknown, turned = np.diag([0.0, 0.0, 1e6]), rotation(turn)
    sights = [
        PlanarGaussian(other.pose, other.covariance * _APART + unknown),
        PlanarGaussian(other.pose @ PlanarPose(0, 0, turn), turned.T @ (other.covariance * _APART) @ turned + unknown),
    ]
    first, second = (squared_distance(one, sight) for sight in sights)
    assert first == pytest.approx(second, rel=1e-3, abs=1e-3)
    assert first == pytest.approx(squared_way(one, other), rel=1e-3, abs=1e-3)


_APART = np.array([[1, 1, 0], [1, 1, 0], [0, 0, 1]])
"""Factors that leave the position and the direction of a covariance alone with each other."""


@pytest.mark.slow
@given(_poses, _poses, _poses)
def test_the_derivatives_of_a_sighting_are_those_of_its_error(
    rover: PlanarPose, landmark: PlanarPose, place: PlanarPose
) -> None:
    """For errors of any size, by differences."""
    factor = detection_factor(0, 1, place, gtsam.noiseModel.Unit.Create(3))
    values = gtsam.Values()
    values.insert(0, state_of(rover, np.zeros(ERRORS)))
    values.insert(1, pose2(landmark))
    by_both = factor.linearize(values).jacobian()[0]
    for column in range(STATES + 3):
        step, found = np.zeros(STATES + 3), []
        for size in (1e-5, -1e-5):
            step[column] = size
            changed = gtsam.Values()
            changed.insert(0, state_of(rover, np.zeros(ERRORS)) + step[:STATES])
            changed.insert(1, pose2(landmark).retract(step[STATES:]))
            found.append(factor.unwhitenedError(changed))
        change = found[0] - found[1]
        change[2] = math.remainder(change[2], 2 * math.pi)
        assert change / 2e-5 == pytest.approx(by_both[:, column], abs=1e-3)


@given(st.floats(0.01, 3), st.floats(0.01, 3), st.sampled_from([1, -1]))
def test_successive_motions_are_one_motion(first: float, second: float, direction: int) -> None:
    """On a straight line, the bias and the mean slip at the end of a motion are those at the start of the next one."""

    def moved(start: float, distance: float) -> tuple[np.ndarray, np.ndarray]:
        growth = np.diag([0.05, 0.01]) ** 2 * distance
        yaw = YawError(0.01 * start, 0.01 * (start + distance), 1.0)
        motion = slipping_motion(PlanarPose(direction * distance), growth, yaw, 0.02)
        carried = np.diag([0.0, 0, 0, *motion.kept])
        carried[:3] = np.hstack([adjoint(motion.pose.inverse()), motion.by_errors])
        return carried, motion.covariance

    (one, before), (two, after), (both, whole) = moved(2, first), moved(2 + first, second), moved(2, first + second)
    assert two @ one == pytest.approx(both, abs=1e-9)
    assert two @ before @ two.T + after == pytest.approx(whole, abs=2e-5)  # the least covariance is added twice


@pytest.mark.slow
@given(_poses, _rotations, st.tuples(_metres, _metres, _metres), _rotations)
def test_a_sighting_leads_from_the_rover_to_the_surveyed_place(
    rover: PlanarPose, turn: np.ndarray, position: tuple[float, float, float], tilt: np.ndarray
) -> None:
    """For any landmark and any mount: the place that the rover computes is the surveyed one, with the yaw 0."""
    landmark, mount = Pose(turn, np.array(position)), Pose(tilt, np.array([0.3, 0.1, 0.5]))
    base = Pose(rotation_of(np.array([0, 0, rover.yaw])), np.array([rover.x, rover.y, 0]))
    seen = (base @ mount).inverse() @ landmark
    turned = geometry_msgs.Quaternion(*quaternion_of(seen.rotation).tolist())
    pose = geometry_msgs.Pose(geometry_msgs.Point(*seen.translation.tolist()), turned)
    with_covariance = geometry_msgs.PoseWithCovariance(pose, (1e-4 * np.eye(6)).ravel().tolist())
    result = vision_msgs.ObjectHypothesisWithPose(vision_msgs.ObjectHypothesis("7", 1.0), with_covariance)
    header = header_of(1, "camera")
    detection = vision_msgs.Detection3D(header, [result], vision_msgs.BoundingBox3D(), "aruco_7")
    known = Landmarks("map", {7: Landmark(landmark)})
    (place,) = planar_detections(vision_msgs.Detection3DArray(header, [detection]), mount, known).values()
    found = rover @ place.pose
    assert (found.x, found.y) == pytest.approx(position[:2], abs=1e-6)
    assert math.remainder(found.yaw, 2 * math.pi) == pytest.approx(0, abs=1e-6)
    assert place.covariance == pytest.approx(1e-4 * np.eye(3), abs=1e-9)


@pytest.mark.slow
@given(_poses, st.sets(st.integers(0, 5), min_size=0, max_size=2), st.floats(0.5, 3), _angles)
@settings(max_examples=30)
def test_the_landmarks_that_agree_are_those_that_nobody_moved(
    frame: PlanarPose, moved: set[int], way: float, direction: float
) -> None:
    """Up to two of six landmarks stand elsewhere, each in another direction; detections are in any frame."""
    places = {number: PlanarPose(3.0 * number, (number * number) % 5, 0.0) for number in range(6)}
    survey = {number: PlanarGaussian(place, 1e-4 * np.eye(3)) for number, place in places.items()}
    seen = {}
    for number, place in places.items():
        angle = direction + number
        shift = PlanarPose(way * math.cos(angle), way * math.sin(angle)) if number in moved else PlanarPose()
        seen[number] = frame @ shift @ place
    joint = np.zeros((3, 3))
    found = agreeing(seen, lambda one, other: 1e-4 * np.eye(3) if one == other else joint, survey, ())
    assert found == set(range(6)) - moved


def test_odometry_that_was_started_again_begins_a_new_track() -> None:
    """Its pose jumps, or its time; a repeated point changes nothing."""
    track = OdometryTrack(0.02)
    at = [OdometryPoint(10**9 * second, PlanarPose(2.0 * second), np.eye(3), 1.0) for second in range(20)]
    assert all(track.add(point) for point in at)
    assert track.add(at[-1])
    assert track.at(12_500_000_000) is not None
    assert not track.add(OdometryPoint(at[-1].stamp + 10**8, PlanarPose(), np.eye(3), 1.0))
    assert track.at(12_500_000_000) is None
    assert track.newest is not None
    assert not track.add(OdometryPoint(10**9, PlanarPose(), np.eye(3), 1.0))


def test_the_slip_that_stays_the_same_is_a_part_of_each_motion() -> None:
    """It lengthens or shortens the way by the part that is given, if the message tells the slip that varies."""
    track = OdometryTrack(0.1)
    points = [OdometryPoint(10**9 * n, PlanarPose(2.0 * n), np.eye(3), 1.0, slip=1e-4) for n in range(2)]
    assert all(track.add(point) for point in points)
    assert track.newest is not None
    assert abs(points[0].motion_to(track.newest).by_errors[0, 1]) == pytest.approx(0.2)


def test_sightings_in_between_tell_hardly_more_about_a_landmark() -> None:
    """Their errors are alike, and half of a sighting's variance is in all of them: many leave at least this half."""
    points = [OdometryPoint(10**9 * n, PlanarPose(0.25 * n), 1e-8 * np.eye(3), 0.0) for n in range(9)]
    variances = []
    for step in (1, 4):
        graph = FieldGraph({7: PlanarGaussian(PlanarPose(4.0), 1e-6 * np.eye(3))}, Reasons())
        for point in points[::step]:
            graph.see({7: PlanarGaussian(point.pose.inverse() @ PlanarPose(4.0), 4e-4 * np.eye(3))}, point)
        found = graph.pose(points[-1])
        assert found is not None
        variances.append(found.covariance[0, 0])
    assert variances[0] > max(2e-4, 0.8 * variances[1])


@pytest.mark.parametrize(("growth", "x"), [(1e-8, 0.01), (1e-2, 0.05)])
def test_a_sighting_from_nearly_one_place_corrects_a_coarse_odometry(growth: float, x: float) -> None:
    """It puts the rover where it is, 4 cm from its place by odometry; beside an exact odometry it tells nothing new."""
    graph = FieldGraph({7: PlanarGaussian(PlanarPose(4.0), 1e-6 * np.eye(3))}, Reasons())
    for n, true in enumerate((0.0, 0.05)):
        point = OdometryPoint(10**9 * (n + 1), PlanarPose(0.01 * n), (n + 1) * growth * np.eye(3), growth)
        graph.see({7: PlanarGaussian(PlanarPose(4.0 - true), 4e-4 * np.eye(3))}, point)
    found = graph.pose(point)
    assert found is not None
    assert found.pose.x == pytest.approx(x, abs=0.005)


def test_innovations_that_are_too_large_tell_by_how_much_the_variances_are_too_small() -> None:
    """A single one counts only up to the gate; as many as expected, or smaller ones, change nothing."""
    recent = RecentInnovations()
    for squared, times, factor in ((1e6, 1, gate_limit(2) / 4 + 0.5), (2.0, 10, 1.0), (12.0, 10, 122 / 22)):
        for _ in range(times):
            recent.add(squared, 2, passes=True)
        assert recent.variance_factor == pytest.approx(factor)
