"""Frames of a board that are made quickly: a plane before a pinhole camera, drawn by OpenCV, without a lens."""

from __future__ import annotations

from collections.abc import Iterator

import cv2
import numpy as np
from numpy.typing import NDArray
from roverkit.calibration import AprilGrid, CalibrationBoard, CharucoBoard

BOARD = CharucoBoard()
SIZE = (640, 480)
MATRIX = np.array([[600.0, 0, 325.3], [0, 602.4, 236.1], [0, 0, 1]])
DISTANCES = (0.31, 0.45, 0.36, 0.62)  # Metres
TILTS = ((0, 32), (32, 0), (0, -32), (-32, 0), (0, 0), (22, 22), (-22, 22))  # Degrees about the image's x and y
PLACES = ((0.5, 0.5), (0.2, 0.25), (0.8, 0.25), (0.2, 0.75), (0.8, 0.75), (0.5, 0.2), (0.5, 0.8), (0.3, 0.5))
"""Where in the image the board's middle is, in parts of its size."""
_FINE = 3  # pixels of the drawing a pixel of the frame
_SQUARE = 40  # pixels of the print


def frame(
    tilt: tuple[float, float],
    place: tuple[float, float],
    distance: float,
    board: CalibrationBoard = BOARD,
    seed: int = 0,
) -> NDArray[np.uint8]:
    """A frame (H, W) of a board that is tilted by degrees about the image's x and y."""
    rotation, _ = cv2.Rodrigues(np.radians([*tilt, 0.0]))
    middle = np.linalg.solve(MATRIX, [place[0] * SIZE[0], place[1] * SIZE[1], 1.0]) * distance
    shift = middle - rotation @ board.outline.mean(axis=0)
    to_image = MATRIX @ np.column_stack([rotation[:, :2], shift])
    grey, metre = _print(board)
    grey = cv2.copyMakeBorder(grey, *[_SQUARE // 2] * 4, cv2.BORDER_CONSTANT, value=255)
    # places are counted from the corners of pixels here, and from their centres by OpenCV
    to_board = np.array([[1 / metre, 0, (0.5 - _SQUARE / 2) / metre], [0, 1 / metre, (0.5 - _SQUARE / 2) / metre]])
    finer = np.array([[_FINE, 0, (_FINE - 1) / 2], [0, _FINE, (_FINE - 1) / 2], [0, 0, 1]])
    warp = finer @ to_image @ np.vstack([to_board, [0, 0, 1]])
    size = (_FINE * SIZE[0], _FINE * SIZE[1])
    drawn = cv2.warpPerspective(grey, warp, size, flags=cv2.INTER_LINEAR, borderValue=150)
    small = cv2.resize(drawn.astype(np.float32), SIZE, interpolation=cv2.INTER_AREA)
    noise = np.random.default_rng(seed).normal(0, 1.5, small.shape)
    return np.clip(np.rint(20 + 0.8 * cv2.GaussianBlur(small, (0, 0), 0.7) + noise), 0, 255).astype(np.uint8)


def _print(board: CalibrationBoard) -> tuple[NDArray[np.uint8], float]:
    """A drawing of the board without a margin, and the number of its pixels in a metre."""
    art = board.artwork
    metre = _SQUARE / (board.tag if isinstance(board, AprilGrid) else art.square)
    if isinstance(board, CharucoBoard):
        size = round(board.size[0] * metre), round(board.size[1] * metre)
        return np.asarray(board.opencv.generateImage(size, marginSize=0)), metre
    grey = np.full([round(length * metre) for length in reversed(board.size)], 255, np.uint8)
    masks = [(left, top, np.ones((1, 1), np.bool_), art.square) for left, top in art.squares]
    masks += [(one.left, one.top, one.black, art.marker) for one in art.markers]
    for left, top, black, side in masks:
        module = round(side * metre / len(black))
        whole = np.kron(black, np.ones((module, module), np.bool_))
        row, column = round(top * metre), round(left * metre)
        grey[row : row + len(whole), column : column + len(whole)][whole] = 0
    return grey, metre


def frames(count: int, board: CalibrationBoard = BOARD) -> Iterator[NDArray[np.uint8]]:
    """Frames in which place, distance and tilt change."""
    for index in range(count):
        tilt = TILTS[(index + index // len(PLACES)) % len(TILTS)]
        yield frame(tilt, PLACES[index % len(PLACES)], DISTANCES[index % len(DISTANCES)], board, seed=index)
