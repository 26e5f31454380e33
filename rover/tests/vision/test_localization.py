"""Where a camera, or a rover with cameras, is on a field."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from roverkit.vision import Landmark, Landmarks, Pose, TargetId, localize
from roverkit.vision.localization.pose_from_landmarks import CameraDetections, localize_rover
from roverkit.vision.poses.pose import rotation_of

from rover.tests.vision.seen import camera_on_field, view, wall

EXACT = (1e-4, 1e-4)  # Metres and radians to which the landmarks are known


def landmarks(places: dict[TargetId, Pose], sigmas: tuple[float, float] = EXACT) -> Landmarks:
    return Landmarks("field", {number: Landmark(place, *sigmas) for number, place in places.items()})


@pytest.mark.slow
def test_the_covariance_is_honest_about_survey_and_noise() -> None:
    """With landmarks off by what their survey says, the squared error is 6 on average, to 4 sigma of 40 draws' mean."""
    rng, nees = np.random.default_rng(1), []
    sigmas = (0.01, 0.005)
    for _ in range(40):
        camera, places = camera_on_field(rng), wall()
        off = {n: place.moved(rng.normal(0, np.repeat(sigmas, 3))) for n, place in places.items()}
        found = localize(view(camera, off, rng), landmarks(places, sigmas))
        assert found
        error = found.pose.change_to(camera)
        nees.append(error @ np.linalg.solve(found.covariance, error))
    assert np.mean(nees) == pytest.approx(6, abs=4 * (12 / 40) ** 0.5)


@pytest.mark.parametrize("moved", [1, 2, 3, 4])
def test_a_moved_or_turned_marker_is_named_and_left_out(moved: int) -> None:
    """The others agree, and the pose is theirs; a marker that hangs askew is no landmark either."""
    rng = np.random.default_rng(moved)
    camera, places = camera_on_field(rng), wall()
    rotation, translation = places[moved].rotation, places[moved].translation
    askew = Pose(rotation @ rotation_of(np.array([0, 0, np.radians(20)])), translation)
    for other in (*(Pose(rotation, translation + np.array([0, by, 0])) for by in (0.1, 1.0)), askew):
        found = localize(view(camera, {**places, moved: other}, rng), landmarks(places, (0.005, 0.005)))
        assert found
        assert (found.rejected, set(found.used)) == ((moved,), set(places) - {moved})
        assert found.pose.translation == pytest.approx(camera.translation, abs=0.05)


def test_strangers_are_ignored() -> None:
    """A marker that is no landmark, or shares its number, is neither used nor rejected; alone, it tells nothing."""
    rng = np.random.default_rng(2)
    camera, places = camera_on_field(rng), wall()
    seen = view(camera, places, rng)
    known = landmarks({number: place for number, place in places.items() if number != 3})
    doubtful = replace(seen[2], shared=True)
    for detections, landmark in ((seen, known), ([doubtful, doubtful, *seen[:2], seen[3]], landmarks(places))):
        found = localize(detections, landmark)
        assert found
        assert (set(found.used), found.rejected) == ({1, 2, 4}, ())
    assert localize([seen[2]], known) is None
    assert localize([doubtful], landmarks(places)) is None
    assert localize([], known) is None


_AHEAD = np.array([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]])  # optical axes in those of the rover: z is x, x is -y
FRONT = Pose(_AHEAD, np.array([0.3, 0.1, 0.4]))
LEFT = Pose(rotation_of(np.array([0, 0, 0.6])) @ _AHEAD, np.array([-0.2, 0.3, 0.5]))
"""Mounts: from the optical frame of a camera to the frame of the rover."""


def test_the_rover_is_where_its_camera_and_its_mount_say() -> None:
    """The pose is that of the camera through the mount; a turn of the camera moves the rover by the lever between."""
    rng = np.random.default_rng(4)
    camera = camera_on_field(rng)
    detections = view(camera, wall(), rng)
    one, joint = (
        localize(detections, landmarks(wall())),
        localize_rover([CameraDetections(detections, FRONT)], landmarks(wall())),
    )
    assert one
    assert joint
    through = one.pose @ FRONT.inverse()
    assert joint.pose.translation == pytest.approx(through.translation, abs=1e-5)
    assert joint.pose.angle_to(through) < 1e-5
    change = np.eye(6)
    change[:3, 3:] = np.cross(through.translation - one.pose.translation, np.eye(3))
    assert joint.covariance == pytest.approx(change @ one.covariance @ change.T, rel=2e-2, abs=1e-9)
    assert through.translation == pytest.approx((camera @ FRONT.inverse()).translation, abs=0.02)


@pytest.mark.slow
def test_two_cameras_give_one_pose_with_an_honest_covariance() -> None:
    """It is better than that of each camera, and the squared error is 6 on average."""
    rng, nees, joint, single = np.random.default_rng(5), [], [], []
    known = landmarks(wall(), (0.004, 0.004))
    for _ in range(40):
        rover = camera_on_field(rng) @ FRONT.inverse()
        off = {n: place.moved(rng.normal(0, 0.004, 6)) for n, place in wall().items()}
        front = CameraDetections(view(rover @ FRONT, {n: off[n] for n in (2, 3)}, rng), FRONT)
        left = CameraDetections(view(rover @ LEFT, {n: off[n] for n in (1, 4)}, rng), LEFT)
        found, alone = localize_rover([front, left], known), localize_rover([front], known)
        assert found
        assert alone
        error = found.pose.change_to(rover)
        nees.append(error @ np.linalg.solve(found.covariance, error))
        joint.append(np.linalg.norm(error[:3]))
        single.append(np.linalg.norm(alone.pose.change_to(rover)[:3]))
    assert np.mean(nees) == pytest.approx(6, abs=4 * (12 / 40) ** 0.5)
    assert np.median(joint) < 0.7 * np.median(single)


@pytest.mark.parametrize(("moved", "agreed"), [((), True), ((1,), True), ((1, 2), False), ((1, 2, 3), False)])
def test_landmarks_agree_if_most_of_them_fit(moved: tuple[int, ...], agreed: bool) -> None:
    """Where half of them contradict the others, nobody knows which ones are right."""
    rng = np.random.default_rng(6)
    camera, places = camera_on_field(rng), wall()
    shifts = {number: np.array([0, 0.3 * number, -0.2 * number]) for number in moved}
    really = {n: Pose(place.rotation, place.translation + shifts.get(n, 0)) for n, place in places.items()}
    found = localize(view(camera, really, rng), landmarks(places, (0.005, 0.005)))
    assert found
    assert found.agreed is agreed
