"""What is seen of a board in an image."""

from __future__ import annotations

import functools

import cv2
import numpy as np
import pytest
from roverkit.calibration import AprilGrid, BoardDetector, CalibrationBoard, CharucoBoard, Chessboard
from roverkit.calibration.charuco_board import OFFSET
from roverkit.vision.images.rendering import Grey, Lens, Pose, render, texture
from roverkit.vision.printing import board_sheet, to_png

from rover.bench.vision.boards import BOARD, board_print, true_corners
from rover.bench.vision.scenes import lens
from rover.tests.vision.board_frames import frame

CAMERA = lens()
POSE = Pose(cv2.Rodrigues(np.array([0.5, -0.3, 0.1]))[0] @ np.diag([1.0, -1, -1]), np.array([0.01, -0.005, 0.55]))


@functools.cache
def rendered() -> Grey:
    """A frame of known truth, all of the board in it."""
    rng = np.random.default_rng(5)
    return render(CAMERA, texture(CAMERA.size, rng), [(board_print(40), POSE)], rng)


@pytest.mark.slow
def test_corners_are_found_to_hundredths_of_a_pixel() -> None:
    """All of them; and their standard deviations are what the errors have."""
    view = BoardDetector(BOARD).find(rendered())
    assert view.ids.tolist() == list(range(70))
    miss = view.corners - true_corners(CAMERA, POSE, view.ids)
    assert np.sqrt((miss**2).sum(axis=1).mean()) < 0.02
    assert (miss**2 / view.sigmas[:, None] ** 2).mean() == pytest.approx(1, abs=0.35)  # 3 sigma of 140 squares
    assert view.blur == pytest.approx((0.8**2 + 1 / 12) ** 0.5, abs=0.05)  # the renderer's, and a pixel's


@pytest.mark.slow
def test_edges_that_a_wide_lens_bends_do_not_move_their_corners() -> None:
    """Corners near the rim of a fisheye lens are not off towards the middle, although their edges are curved."""
    matrix = np.array([[267.0, 0, 322.3], [0, 267.8, 237.4], [0, 0, 1]])
    camera = Lens(matrix, (0.02, -0.008, 0.003, -0.0008), (640, 480), fisheye=True)
    pose = Pose(np.diag([1.0, -1, -1]), np.array([0.2, 0.09, 0.17]))
    shown = render(camera, np.full((480, 640), 120.0), [(board_print(40), pose)], np.random.default_rng(3))
    view = BoardDetector(BOARD).find(shown)
    outwards = view.corners - matrix[:2, 2]
    distances = np.linalg.norm(outwards, axis=1)
    miss = ((view.corners - true_corners(camera, pose, view.ids)) * outwards).sum(axis=1) / distances
    far = distances > 160
    assert far.sum() > 30
    assert abs(miss[far].mean()) < 0.008  # with straight edges, 0.017


@pytest.mark.slow
def test_the_offset_of_this_opencv_is_known() -> None:
    """Its corners are off the truth by as much as is taken from them, and have the same numbers."""
    corners, ids = cv2.aruco.CharucoDetector(BOARD.opencv).detectBoard(rendered())[:2]
    miss = np.reshape(corners, (-1, 2)) - true_corners(CAMERA, POSE, np.ravel(ids))
    assert np.median(miss, axis=0) == pytest.approx([OFFSET, OFFSET], abs=0.02)  # none from 5.0 on, half a pixel before
    for board in (BOARD, CharucoBoard(5, 7, 0.03, 0.022)):
        assert board.points == pytest.approx(np.asarray(board.opencv.getChessboardCorners()), abs=1e-7)


@pytest.mark.slow
def test_corners_that_are_hidden_are_left_out() -> None:
    """What covers a corner is no corner, even if the markers around it tell where it should be."""
    detector = BoardDetector(BOARD)
    covered = rendered().copy()
    x, y = detector.find(covered).corners[34].astype(int)
    covered[y - 5 : y + 6, x - 9 : x + 3] = 90
    view = detector.find(covered)
    assert 34 not in view.ids
    assert len(view.ids) >= 65
    assert (detector.find(cv2.cvtColor(covered, cv2.COLOR_GRAY2BGR)).corners == view.corners).all()


@pytest.mark.parametrize("legacy", [True, False])
def test_boards_of_old_are_seen_as_such(legacy: bool) -> None:
    """A board with an even number of rows from before OpenCV 4.6 begins with a white square."""
    board = CharucoBoard(8, 6, 0.03, 0.022, legacy=legacy)
    view = BoardDetector(board).find(frame((0, 20), (0.5, 0.5), 0.5, board))
    assert len(view.ids) == 35


@pytest.mark.slow
@pytest.mark.parametrize("board", [Chessboard(8, 6, 0.03), AprilGrid(5, 4, 0.03)], ids=["chessboard", "aprilgrid"])
def test_other_boards_are_found_from_all_sides(board: CalibrationBoard) -> None:
    """Their corners are where they were printed, up to the board's symmetry, however the camera is turned."""
    sheet = cv2.imdecode(np.frombuffer(to_png(board_sheet(board, "A4"), 100), np.uint8), cv2.IMREAD_GRAYSCALE)
    for turns in range(4):
        image = np.ascontiguousarray(np.rot90(cv2.GaussianBlur(sheet, (0, 0), 0.7), turns))
        view = BoardDetector(board).find(image)
        assert len(view.ids) >= 0.9 * len(board.points)
        homography, _ = cv2.findHomography(board.points[view.ids, :2], view.corners)
        lifted = np.column_stack([board.points[view.ids, :2], np.ones(len(view.ids))]) @ homography.T
        assert lifted[:, :2] / lifted[:, 2:] == pytest.approx(view.corners, abs=0.6)  # edges are rounded to pixels
        assert np.linalg.det(homography[:2, :2]) > 0  # not mirrored
