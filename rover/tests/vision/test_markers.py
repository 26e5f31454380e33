"""Markers in one frame: the rendered truth, the ways to look for them, their dictionary, and the fit of their edges."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
import pytest
from roverkit.vision.images.rendering import Floats, Print, marker_print, project, render, texture
from roverkit.vision.markers.detection import Detector, Region
from roverkit.vision.markers.dictionaries import other_dictionary
from roverkit.vision.markers.edges import Fit, Guess, fit_edges
from roverkit.vision.markers.flips import Flips
from roverkit.vision.markers.marker_set import MarkerSet
from roverkit.vision.poses.pnp import Solution
from roverkit.vision.poses.pose import Pose as VisionPose
from roverkit.vision.poses.pose import rotation_of

from rover.bench.vision.contestants import camera_of
from rover.bench.vision.scenes import SIDE, Scene, corner_points, lens, random_pose, scenes

LENS, SMALL = lens(), lens(320, 240)
CAMERA, MARKERS = camera_of(LENS), MarkerSet()
DETECTOR = Detector(MARKERS)


@pytest.fixture(scope="module")
def film() -> Sequence[Scene]:
    """Frames with markers of 48 pixels."""
    return list(scenes(48, 12, 100))


@pytest.mark.parametrize("seed", range(3))
def test_a_square_is_where_its_projection_is(seed: int) -> None:
    """The centre of a rendered square's light is the centre of its outline's area: no half pixel is lost."""
    rng = np.random.default_rng(seed)
    pose = random_pose(LENS, 40, rng)
    plane = Print(np.full((30, 30), 250, np.uint8), SIDE / 30)
    frame = render(LENS, np.full((480, 640), 10.0), [(plane, pose)], rng, noise_sigma=0).astype(float) - 10
    rows, columns = np.indices(frame.shape)
    light = np.array([(frame * columns).sum(), (frame * rows).sum()]) / frame.sum()
    moments = cv2.moments(project(LENS, pose, corner_points()).astype(np.float32))
    assert light == pytest.approx(np.array([moments["m10"], moments["m01"]]) / moments["m00"], abs=0.03)


@pytest.mark.slow
@pytest.mark.parametrize("way", ["scan", "scan_quickly", "scan_region"])
def test_corners_count_from_the_centres_of_the_frame_s_pixels(film: Sequence[Scene], way: str) -> None:
    """No way to look shifts the corners, whatever OpenCV's version: a lost half pixel would be seen here."""
    where = [Region(3, 5, 639, 478)] if way == "scan_region" else []
    offsets = [
        (one.corners - scene.corners).mean(axis=0)
        for scene in film
        for one in getattr(DETECTOR, way)(scene.frame, *where)
        if one.number == scene.number
    ]
    assert len(offsets) >= len(film) - 1
    assert np.mean(offsets, axis=0) == pytest.approx([0, 0], abs=0.15)


@pytest.mark.slow
@pytest.mark.opencv
@pytest.mark.parametrize(
    ("chosen", "shown", "numbers", "expected"),
    [
        ("DICT_5X5_250", "DICT_4X4_50", [3], "DICT_4X4_50"),
        ("DICT_5X5_250", "DICT_6X6_1000", [120], "DICT_6X6_250"),
        ("DICT_5X5_250", "DICT_5X5_1000", [700], "DICT_5X5_1000"),
        ("DICT_5X5_250", "DICT_APRILTAG_36h11", [20], "DICT_APRILTAG_36h11"),
        ("DICT_5X5_250", "DICT_ARUCO_ORIGINAL", [60], "DICT_ARUCO_ORIGINAL"),
        ("DICT_5X5_100", "DICT_5X5_250", [], None),
        ("DICT_5X5_100", "DICT_5X5_250", [30], None),
    ],
)
def test_another_dictionary_is_the_smallest(chosen: str, shown: str, numbers: list[int], expected: str | None) -> None:
    """Of a family, it mistakes the fewest squares for markers; neither background nor a chosen marker makes one."""
    rng = np.random.default_rng(8)
    prints = [marker_print(getattr(cv2.aruco, shown), number, SIDE, texels=8) for number in numbers]
    frame = render(SMALL, texture(SMALL.size, rng), [(plane, random_pose(SMALL, 50, rng)) for plane in prints], rng)
    found = other_dictionary(frame, camera_of(SMALL), MarkerSet(chosen))
    assert found == (None if expected is None else (expected, numbers))


def fit(scene: Scene, off: Floats | float = 0.3) -> Fit:
    """Fit from corners that are off by some pixels."""
    found = fit_edges(scene.frame, CAMERA, [Guess(MARKERS.pattern(scene.number), scene.corners + off)])[0]
    assert found
    return found


def miss(found: Fit, scene: Scene) -> float:
    """The root mean squared error of the corners in pixels."""
    return float(np.sqrt(((CAMERA.distort(found.rays) - scene.corners) ** 2).mean()))


def test_corners_are_exact_and_their_covariance_is_honest(film: Sequence[Scene]) -> None:
    """At 48 pixels, noise of 2 grey levels allows 0.01 pixels; noise, contrast and blur are found, the NEES is 8."""
    found = [fit(scene) for scene in film]
    errors = list(map(miss, found, film))
    assert np.median(errors) < 0.015
    assert max(errors) < 0.03
    missed = [(LENS.rays(scene.corners) - one.rays).ravel() for one, scene in zip(found, film)]
    nees = [error @ np.linalg.solve(one.covariance, error) for one, error in zip(found, missed)]
    assert 4 < np.mean(nees) < 12.5
    assert np.median([one.noise for one in found]) == pytest.approx(2.02, rel=0.1)
    assert np.median([one.contrast for one in found]) == pytest.approx(200, rel=0.05)
    assert np.median([one.blur for one in found]) == pytest.approx((0.8**2 + 1 / 12) ** 0.5, rel=0.03)
    assert min(one.explained for one in found) > 0.98


def test_a_detector_s_error_does_not_matter(film: Sequence[Scene]) -> None:
    """From corners that are off by two pixels, each in a direction of its own, the fit arrives."""
    rng = np.random.default_rng(0)
    for scene in film:
        angles = rng.uniform(0, 2 * np.pi, 4)
        assert miss(fit(scene, 2 * np.column_stack([np.cos(angles), np.sin(angles)])), scene) < 0.05


@pytest.mark.slow
@pytest.mark.opencv
def test_what_is_not_there_is_not_explained(film: Sequence[Scene]) -> None:
    """The wrong pattern, a plain wall, or a guess where no ray goes explain nothing or are None; others stand."""
    for scene in film:
        found = fit_edges(scene.frame, CAMERA, [Guess(MARKERS.pattern((scene.number + 1) % 250), scene.corners)])[0]
        assert found is None or found.explained < 0.9
    assert fit_edges(film[0].frame, CAMERA, []) == []
    good = Guess(MARKERS.pattern(film[0].number), film[0].corners)
    found, lost = fit_edges(film[0].frame, CAMERA, [good, Guess(good.pattern, film[0].corners + 5000)])
    assert found
    assert lost is None
    plain = fit_edges(np.full((480, 640), 128, np.uint8), CAMERA, [good])[0]
    assert plain is None or abs(plain.contrast) < 8


def decide(flips: Flips, frame: int, **chi2: float) -> str:
    """The name of the solution that was decided for, of some that lean to the left or the right, best first."""
    names = sorted(chi2, key=lambda name: chi2[name])
    turns = {"left": -0.5, "right": 0.5, "front": 0.0}
    poses = [VisionPose(rotation_of(np.array([0, turns[name], 0])), np.array([0, 0, 1.0])) for name in names]
    solutions = [Solution(pose, np.eye(6), chi2[name], 1e-5) for name, pose in zip(names, poses)]
    chances = flips.weigh(solutions, frame * 33_000_000)
    return names[chances.index(max(chances))]


def test_a_decision_is_turned_over_by_many_frames_alone() -> None:
    """Noise of a moment changes nothing, and a sight of seconds ago says nothing; a wrong decision is taken back."""
    flips = Flips()
    assert {decide(flips, frame, left=1.0, right=6.0) for frame in range(10)} == {"left"}
    assert decide(flips, 10, left=6.0, right=1.0) == "left"
    assert decide(flips, 300, left=4.0, right=1.0) == "right"
    flips = Flips()
    assert decide(flips, 0, left=1.0, right=3.0) == "left"
    assert [decide(flips, frame, left=5.0, right=1.0) for frame in range(1, 9)][-1] == "right"
