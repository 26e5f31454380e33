"""Reading of the markers in squares that a detector has found and could not read.

OpenCV reads a cell of a marker from the share of its pixels that are white, and gives up when a few cells are covered,
blurred or shaded. Here, each cell is the mean of some points around its centre, which keep away from its neighbours.
The cells are compared with each pattern of the dictionary, its black border included, while the light may vary
quadratically over the square: a black cell in a highlight can be brighter than a white one beside it. A wrong reading
is possible; the edge fit, which compares all edges of the pattern with the image, rejects it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.opencv import cv2
from roverkit.vision.poses.homography import apply, homographies

_NEAR = (-0.2, 0.0, 0.2)
"""Distances of the points from the centre of a cell, along both sides, in cells."""
_CONTRAST = 8.0
"""Least difference between the means of white and black cells, in grey levels."""
_CHANCE = 0.01
"""Largest share of the squares with random cells that are read as a marker; the edge fit then rejects them."""
_BORDER = 0.2
"""Largest share of the cells of the black border that may be white, because something covers them."""


class SquareReader:
    """Reads the markers of one dictionary."""

    def __init__(self, white: NDArray[np.bool_], *, exact: bool = False) -> None:
        """Read the markers whose cells inside the border are `white` (D, n, n); with `exact`, none may be wrong."""
        self._cells = white.shape[1] + 2
        self._most_wrong = 0 if exact else _most_wrong(4 * len(white), white[0].size)
        whole = np.pad(white, ((0, 0), (1, 1), (1, 1)))
        turned = np.stack([np.rot90(whole, turns, axes=(1, 2)) for turns in range(4)], axis=1)
        self._white = turned.reshape(4 * len(white), -1)
        inside = np.zeros((self._cells, self._cells), dtype=bool)
        inside[1:-1, 1:-1] = True
        self._inside = inside.ravel()
        centres = (np.arange(self._cells) + 0.5) * (2 / self._cells) - 1
        steps = (centres[:, None] + np.array(_NEAR) * (2 / self._cells)).ravel()
        self._points = np.stack([axis.ravel() for axis in np.meshgrid(steps, steps)]).astype(np.float32)
        u, v = (axis.ravel() for axis in np.meshgrid(centres, centres))
        light = np.stack([np.ones_like(u), u, v, u * u, u * v, v * v], axis=1)
        self._light = np.linalg.qr(light)[0].astype(np.float32)
        patterns = self._without_light(np.where(self._white, np.float32(0.5), np.float32(-0.5)))
        self._lengths = np.linalg.norm(patterns, axis=1)
        self._patterns = patterns / self._lengths[:, None]

    def read(self, image: NDArray[np.uint8], squares: Sequence[Floats]) -> list[tuple[int, Floats, int]]:
        """Return the markers in squares of a grey image (H, W): number, corners in OpenCV's order, and wrong cells.

        The corners (4, 2) of a square are in pixels, clockwise from any of them.
        """
        if not squares:
            return []
        corners = np.stack([np.reshape(square, (4, 2)) for square in squares]).astype(float)
        with np.errstate(all="ignore"):
            places = apply(homographies(corners.transpose(0, 2, 1)).astype(np.float32), self._points)
        x, y = np.nan_to_num(places).transpose(1, 0, 2).copy()
        grey = cv2.remap(image, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        near = len(_NEAR)
        cells = grey.reshape(-1, self._cells, near, self._cells, near).mean(axis=(2, 4), dtype=np.float32)
        cells = cells.reshape(len(corners), -1)
        agreement = self._without_light(cells) @ self._patterns.T
        best = agreement.argmax(axis=1)
        white = self._white[best]
        contrast = agreement[np.arange(len(best)), best] / self._lengths[best]
        flat = cells - np.where(white, contrast[:, None] / 2, -contrast[:, None] / 2)  # black and white alike
        wrong = white != (cells > flat - self._without_light(flat))
        count = wrong[:, self._inside].sum(axis=1)
        usable = (
            (contrast > _CONTRAST) & (wrong[:, ~self._inside].mean(axis=1) <= _BORDER) & (count <= self._most_wrong)
        )
        # A pattern that is turned by 90 degrees has its first corner where the second one was.
        return [
            (int(best[place]) // 4, np.roll(corners[place], int(best[place]) % 4, axis=0), int(count[place]))
            for place in np.flatnonzero(usable).tolist()
        ]

    def _without_light(self, cells: Floats) -> Floats:
        """Return grey values (R, N) of cells without the part that varies as light does."""
        rest: Floats = cells - (cells @ self._light) @ self._light.T
        return rest


def _most_wrong(codes: int, cells: int) -> int:
    """Return how many cells of a marker may be wrong, so that few squares that are no markers are read as one."""
    wrong, chance = 0, codes / 2**cells
    while (chance := chance + codes * math.comb(cells, wrong + 1) / 2**cells) < _CHANCE:
        wrong += 1
    return wrong
