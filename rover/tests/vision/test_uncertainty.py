"""Errors beside the noise of the image: what is known about them, and how they reach the covariances."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from roverkit.vision import CameraParameters, LandmarkDetection, MarkerSet, Tracker, read_parameters, write_parameters
from roverkit.vision.camera import uncertainty
from roverkit.vision.camera.uncertainty import Uncertainty, camera_roots, pixels_by_camera, pixels_to_rays
from roverkit.vision.localization.landmarks import Landmark, Landmarks
from roverkit.vision.localization.pose_from_landmarks import localize

from rover.bench.vision.accuracy import miss_of
from rover.bench.vision.contestants import Ours, camera_of
from rover.bench.vision.degradations import DEGRADATIONS, READOUT_S, degraded_scenes
from rover.bench.vision.scenes import SIDE, DriveFrame, drive, lens
from rover.tests.vision.seen import camera_on_field, view, wall
from roverlink.runtime.core.errors import SetupError

CAMERA = camera_of(lens(1280, 720))
NOTHING = Uncertainty(side_sigma=0, corner_floor=0)


@cache
def seen(exact: bool = True, **changed: float) -> tuple[LandmarkDetection, ...]:
    """Markers in the second frame of a camera that moves, with a certainty that is perfect unless it is changed."""
    camera = replace(CAMERA, covariance=np.zeros((4, 4))) if exact else CAMERA
    tracker = Tracker(camera, MarkerSet(side=SIDE), uncertainty=replace(NOTHING, **changed))
    return [tracker.track(shot.frame, shot.stamp) for shot in film()][-1]


@cache
def film() -> list[DriveFrame]:
    return list(drive(2, 5))


@pytest.mark.slow
def test_an_unknown_side_makes_the_distance_uncertain() -> None:
    """A side that is known to 1 % gives a distance that is known to 1 %, and the same rotation."""
    for exact, other in zip(seen(), seen(side_sigma=0.01)):
        sight = exact.pose.translation / np.linalg.norm(exact.pose.translation)
        more = other.covariance - exact.covariance
        assert sight @ more[:3, :3] @ sight == pytest.approx(
            (0.01 * np.linalg.norm(exact.pose.translation)) ** 2, rel=1e-4
        )
        assert more[3:, 3:] == pytest.approx(np.zeros((3, 3)), abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("change", [{"corner_floor": 0.1}, {"covariance_scale": 2.0}])
def test_every_uncertainty_enlarges_the_covariance(change: Mapping[str, float]) -> None:
    """No direction becomes more certain; the poses stay the same. The scale multiplies standard deviations."""
    for exact, other in zip(seen(), seen(**change)):
        assert other.pose.change_to(exact.pose) == pytest.approx(
            np.zeros(6), abs=1e-7
        )  # a step of the fit more or less
        each = 1 / np.sqrt(exact.covariance.diagonal())
        more = (other.covariance - exact.covariance) * each * each[:, None]
        assert np.linalg.eigvalsh(more).min() > -1e-6
        assert np.trace(more) > 0.1
        if "covariance_scale" in change:
            assert other.covariance == pytest.approx(4 * exact.covariance, rel=1e-5, abs=1e-13)


@pytest.mark.slow
def test_motion_during_the_readout_is_corrected() -> None:
    """From the second frame on, a known readout time makes poses three times better, and the covariance is honest."""
    moving = next(one for one in DEGRADATIONS if one.speed)
    still, corrected = (Ours(camera_of(lens()), Uncertainty(readout_time=seconds)) for seconds in (0, READOUT_S))
    before, after = [], []
    for degraded in degraded_scenes(moving, 48, 4, 17):
        for estimator, misses in ((still, before), (corrected, after)):
            (found,) = estimator(degraded.scene.frame, degraded.earlier)
            misses.append(miss_of(found, degraded.scene.pose))
    assert np.mean([one.translation for one in after]) < np.mean([one.translation for one in before]) / 3
    assert np.mean([one.nees for one in after]) < 6 * 2**2


def test_a_camera_without_covariance_is_not_exact() -> None:
    """Its focal length counts as known to some thousandths, and so do distances."""
    for exact, other in zip(seen(), seen(exact=False)):
        distance = np.linalg.norm(exact.pose.translation)
        more = np.sqrt(np.trace((other.covariance - exact.covariance)[:3, :3]))
        assert uncertainty.UNKNOWN_CAMERA < more / distance < 3 * uncertainty.UNKNOWN_CAMERA


@pytest.mark.parametrize("size", [4, 9])
def test_the_camera_s_errors_move_rays(size: int) -> None:
    """A camera that differs by one column of the root sees its pixels along rays that differ as predicted."""
    rng = np.random.default_rng(0)
    root = rng.normal(0, 1, (size, size)) * np.array([1, 1, 1, 1, *[1e-3] * 5])[:size, None] * 0.01
    camera = replace(CAMERA, covariance=root @ root.T)
    roots, rays = camera_roots(camera), rng.uniform(-0.4, 0.4, (5, 2))
    assert roots @ roots.T == pytest.approx(root @ root.T)
    shifts = pixels_to_rays(camera, rays, pixels_by_camera(camera, roots, rays))
    for column, shift in zip(roots.T, shifts.T):
        matrix = CAMERA.matrix.copy()
        matrix[[0, 1, 0, 1], [0, 1, 2, 2]] += column[:4]
        other = CameraParameters(matrix, CAMERA.distortion + (column[4:] if size > 4 else 0))
        moved = other.undistort(CAMERA.distort(rays)) - rays
        assert moved.ravel() == pytest.approx(shift, rel=0.05, abs=1e-8)


def test_landmarks_do_not_average_shared_errors_away() -> None:
    """The camera's error stays however many landmarks are seen; errors of the single landmarks become smaller."""
    rng = np.random.default_rng(3)
    known = Landmarks("field", {number: Landmark(place, 1e-6, 1e-6) for number, place in wall().items()})
    detections = view(camera_on_field(rng), wall(), rng)

    def sigma(detections: list[LandmarkDetection]) -> float:
        found = localize(detections, known)
        assert found
        assert len(found.used) == len(detections)
        return float(np.sqrt(found.covariance[0, 0]))

    covariance = np.zeros((4, 4))
    covariance[:2, :2] = 3.0**2  # fx and fy are wrong together
    doubtful = CameraParameters(np.diag([1000.0, 1000, 1]), np.zeros(5), covariance=covariance)
    shared, own = [], []
    for one in detections:
        pixels = pixels_by_camera(doubtful, camera_roots(doubtful), one.seen.rays)
        shifts = pixels_to_rays(doubtful, one.seen.rays, pixels)
        shared.append(replace(one, seen=replace(one.seen, shared=shifts)))
        own.append(replace(one, seen=replace(one.seen, own=shifts @ shifts.T)))
    assert sigma(shared) > 1.5 * sigma(own)
    assert sigma(shared) > 5 * sigma(detections)


def test_the_parameter_file_tells_the_accuracy_of_the_camera(tmp_path: Path) -> None:
    """It has a covariance, the standard deviations of the pinhole, or neither; an impossible accuracy is refused."""
    path, covariance = tmp_path / "camera.yml", np.diag(np.arange(1.0, 10) ** 2)
    write_parameters(path, CAMERA, {"standard_deviations": np.arange(1.0, 10).reshape(1, -1)})
    assert read_parameters(path).covariance == pytest.approx(covariance[:4, :4])
    write_parameters(path, CAMERA, {"parameter_covariance": covariance})
    camera = read_parameters(path)
    assert camera.covariance == pytest.approx(covariance)
    half = camera.scaled((640, 360)).covariance
    assert half is not None
    assert half.diagonal() == pytest.approx(covariance.diagonal() * np.array([0.25] * 4 + [1] * 5))
    write_parameters(path, CAMERA)
    assert read_parameters(path).covariance is None
    for key, value, words in (
        ("parameter_covariance", -np.eye(9), "impossible"),
        ("standard_deviations", np.ones((1, 3)), "needs fx fy"),
    ):
        write_parameters(path, CAMERA, {key: value})
        with pytest.raises(SetupError, match=f"camera.yml:.*{words}"):
            read_parameters(path)
