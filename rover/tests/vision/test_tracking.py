"""Following markers from frame to frame."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
import pytest
from roverkit.vision import Board, LandmarkDetection, MarkerSet, Tracker
from roverkit.vision.images.rendering import Grey, Print, marker_print, render, texture
from roverkit.vision.images.rendering import Pose as TruePose
from roverkit.vision.markers.marker_set import square
from roverkit.vision.markers.tracker import TOGETHER
from roverkit.vision.poses.pose import Pose, rotation_of

from rover.bench.vision.accuracy import miss_of
from rover.bench.vision.contestants import Estimate, camera_of
from rover.bench.vision.finding import raster_print
from rover.bench.vision.scenes import DICTIONARY, SIDE, DriveFrame, drive, lens
from roverlink.runtime.core.errors import SetupError

SIZE = (640, 480)
LENS = lens(*SIZE)
FRAME = 33_000_000


@pytest.fixture(scope="module")
def film() -> Sequence[DriveFrame]:
    """Eight frames of a drive with four markers."""
    return list(drive(8, 5, SIZE))


def tracker(markers: MarkerSet | None = None, **options: float) -> Tracker:
    return Tracker(camera_of(LENS), markers or MarkerSet(side=SIDE), **options)


def off_by(detection: LandmarkDetection, truth: TruePose) -> float:
    """The error of the translation in parts of the distance."""
    return miss_of(Estimate(0, detection.pose.rotation, detection.pose.translation), truth).translation


@pytest.mark.slow
@pytest.mark.parametrize("scan_s", [0, 0.1, 1000])
def test_every_marker_is_seen_in_every_frame(film: Sequence[DriveFrame], scan_s: float) -> None:
    """However it was found - scan, quick scan or region - its pose is the same to a thousandth of the distance."""
    following = tracker(scan_s=scan_s, thorough_s=3 * scan_s)
    for shot in film:
        detections = following.track(shot.frame, shot.stamp)
        assert {one.id for one in detections} == set(shot.poses)
        assert max(off_by(one, shot.poses[one.id]) for one in detections) < 0.002
        assert all(one.stamp == shot.stamp for one in detections)


@pytest.mark.slow
def test_the_whole_frame_is_scanned_where_it_must_be(film: Sequence[DriveFrame]) -> None:
    """For a marker that has jumped, one that is new at the next scan, and time that goes back (another recording)."""
    first, empty = film[0].frame, np.full(SIZE[::-1], 128, np.uint8)
    following = tracker(scan_s=1000, thorough_s=1000)
    following.track(first, 10 * FRAME)
    turned = np.ascontiguousarray(first[::-1, ::-1])
    assert {one.id for one in following.track(turned, 11 * FRAME)} == set(film[0].poses)
    following = tracker()
    counts = [len(following.track(frame, index * FRAME)) for index, frame in enumerate([empty, first, first, first])]
    assert counts == [0, 0, 0, 4]
    following = tracker(scan_s=1000, thorough_s=1000)
    following.track(empty, 10 * FRAME)
    assert len(following.track(first, 0)) == 4


def test_a_sighting_says_all_about_itself(film: Sequence[DriveFrame]) -> None:
    """Corners in pixels, a covariance, both solutions, and how well they fit; a BGR image of greys gives the same."""
    found = tracker().track(film[0].frame, 0)
    for one, other in zip(found, tracker().track(cv2.cvtColor(film[0].frame, cv2.COLOR_GRAY2BGR), 0), strict=True):
        assert one.pose.translation == pytest.approx(other.pose.translation, abs=1e-9)
        assert one.corners.shape == (4, 2)
        projected = camera_of(LENS).project(one.pose.apply(square(SIDE)))
        assert np.abs(projected - one.corners).max() < 0.1
        assert one.error < 0.05
        assert one.ambiguity > 2
        assert np.linalg.eigvalsh(one.covariance).min() > 0
        assert one.pose is one.solutions[0].pose


def test_an_image_of_another_size_or_kind_is_refused(film: Sequence[DriveFrame]) -> None:
    """Such a calibration would give wrong distances in silence; floats and masks are no images."""
    with pytest.raises(SetupError, match=r"640x480.*320x240"):
        tracker().track(film[0].frame[::2, ::2], 0)
    with pytest.raises(SetupError, match="must be uint8"):
        tracker().track(np.zeros(SIZE[::-1], np.float32), 0)


def test_a_board_is_one_landmark() -> None:
    """Its markers, not in one plane, are fitted together; one that is hidden is not missed."""
    rng = np.random.default_rng(0)
    corner = {1: Pose(np.eye(3), np.array([-0.05, 0, 0.0]))}
    corner[2] = Pose(rotation_of(np.array([0, 0.6, 0])), np.array([0.06, 0, 0]))
    board = Board("corner", {number: place.apply(square(SIDE)) for number, place in corner.items()})
    pose = Pose(rotation_of(np.array([0.3, -0.4, 0.2])) @ np.diag([1.0, -1, -1]), np.array([0.02, 0.01, 0.7]))
    following = tracker(MarkerSet(side=SIDE, boards=(board,)))
    for stamp, hidden in enumerate([set(), {2}]):
        placed = {number: pose @ corner[number] for number in corner.keys() - hidden}
        planes = [
            (marker_print(DICTIONARY, number, SIDE, texels=30), TruePose(one.rotation, one.translation))
            for number, one in placed.items()
        ]
        (found,) = following.track(render(LENS, np.full(SIZE[::-1], 110.0), planes, rng), stamp)
        assert found.id == "corner"
        assert found.corners.shape == (4 * len(planes), 2)
        assert found.pose.translation == pytest.approx(pose.translation, abs=1e-3)
        assert found.pose.angle_to(pose) < np.radians(0.5)


def facing_us(number: int, x: float, side_px: float = 40, side: float = SIDE) -> tuple[Print, TruePose]:
    """A marker as it hangs on a wall; `x` is relative to the half width of the image."""
    distance = side * LENS.matrix[0, 0] / side_px
    place = np.array([x * SIZE[0] / 2 / LENS.matrix[0, 0] * distance, 0, distance])
    return marker_print(DICTIONARY, number, side, texels=8), TruePose(np.diag([1.0, -1, -1]), place)


def photograph(*planes: tuple[Print, TruePose]) -> Grey:
    rng = np.random.default_rng(3)
    return render(LENS, texture(SIZE, rng), planes, rng)


@pytest.mark.slow
def test_a_large_marker_is_found_and_followed() -> None:
    """Edges of a raster of 40 pixels are 3 pixels off at 300; meanwhile, a marker in one of its cells is found."""
    following, (_, pose) = tracker(thorough_s=0), facing_us(5, 0, side_px=300)
    large = raster_print(5, 40), pose
    for stamp in (0, FRAME):
        (found,) = following.track(photograph(large), stamp)
        assert (found.id, off_by(found, pose) < 0.02) == (5, True)
    both = following.track(photograph(large, facing_us(9, 43 / 320, 26, SIDE / 13)), 2 * FRAME)
    assert [one.id for one in both] == [5, 9]


def test_all_markers_that_share_a_number_have_poses() -> None:
    """Each at its place, and marked; another marker is not."""
    planes = [facing_us(7, -0.5), facing_us(7, 0.5), facing_us(9, 0)]
    following = tracker()
    for stamp in (0, FRAME):
        found = following.track(photograph(*planes), stamp)
        assert [(one.id, one.shared) for one in found] == [(7, True), (7, True), (9, False)]
        for one, (_, truth) in zip(found, planes, strict=True):
            assert one.pose.translation == pytest.approx(truth.translation, abs=1e-3)


@pytest.mark.parametrize(("together", "shared"), [(1, False), (TOGETHER, True)])
def test_a_shared_number_is_remembered(together: int, shared: bool) -> None:
    """If only one of them is left, nobody knows which. But a single frame with two may have been a mistake."""
    following = tracker()
    both, one = photograph(facing_us(7, -0.5), facing_us(7, 0.5)), photograph(facing_us(7, 0.5))
    for frame in range(together):
        assert len(following.track(both, frame * FRAME)) == 2
    assert [(found.id, found.shared) for found in following.track(one, together * FRAME)] == [(7, shared)]


def test_a_board_does_without_markers_that_share_a_number() -> None:
    """Its pose comes from the others; of the two, each has the pose of its own frame, with the side on the board."""
    corners = {number: square(0.08) + np.array([x, 0, 0]) for number, x in ((1, -0.06), (2, 0.06))}
    following = tracker(MarkerSet(side=SIDE, boards=(Board("gate", corners),)))
    planes = [facing_us(number, x, side=0.08) for number, x in ((1, -0.7), (1, 0.7), (2, 0))]
    found = following.track(photograph(*planes), 0)
    assert [(one.id, one.shared) for one in found] == [(1, True), (1, True), ("gate", False)]
    for one, (_, truth), offset in zip(found, planes, (0, 0, -0.06), strict=True):
        assert one.pose.translation - np.array([offset, 0, 0]) == pytest.approx(truth.translation, abs=2e-3)
