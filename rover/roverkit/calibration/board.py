"""Calibration boards: flat prints with corners at known positions, at which two edges cross.

Each kind of board has a module of its own: `charuco_board`, `chessboard` and `april_grid`. The first two share
`checkered_board`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.markers.detection import Image

Finder = Callable[[Image], tuple[NDArray[np.intp], Floats]]
"""Function that returns the ids (N,), ascending, and pixels (N, 2) of the corners that a grey image shows.

A corner may be wrong by two pixels; its position is fitted later.
"""


@dataclass(frozen=True, slots=True, eq=False)
class PrintedMarker:
    """Marker on a board: the position of its upper left corner in metres, and a mask (n, n) of its black modules."""

    left: float
    top: float
    black: NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Artwork:
    """Black parts of a board, in its frame in metres: squares, and the modules (cells) of markers."""

    squares: tuple[tuple[float, float], ...]
    """Left and upper edge of each black square."""
    square: float
    """Side of a black square."""
    markers: tuple[PrintedMarker, ...] = ()
    marker: float = 0.0
    """Side of a marker."""


class CalibrationBoard(ABC):
    """Flat board whose corners are known.

    The board's frame has its origin at the outer corner of the upper left square. x points along the rows, y down the
    columns, z into the board; the unit is the metre.
    """

    @property
    @abstractmethod
    def description(self) -> str:
        """Kind and sizes of the board in words, without an article."""

    @property
    @abstractmethod
    def size(self) -> tuple[float, float]:
        """Width and height of the board without its margin, in metres."""

    @property
    @abstractmethod
    def points(self) -> Floats:
        """Corners (N, 3) in the board's frame in metres. The id of a corner is its index in this array."""

    @property
    @abstractmethod
    def gap(self) -> float:
        """Distance in metres from a corner to the nearest marker, along both axes; infinite without markers."""

    @property
    @abstractmethod
    def reach(self) -> float:
        """Distance in metres from a corner, along its edges, up to which the edges are straight and uncrossed."""

    @property
    @abstractmethod
    def artwork(self) -> Artwork:
        """Black parts of the board, for printing."""

    @abstractmethod
    def finder(self) -> Finder:
        """Return a function that finds the board's corners in an image."""

    @property
    def outline(self) -> Floats:
        """Outer corners (4, 3) in the board's frame in metres, clockwise from the origin."""
        width, height = self.size
        return np.array([[0, 0, 0], [width, 0, 0], [width, height, 0], [0, height, 0]])


def millimetres(metres: float) -> str:
    """Return a length as text in millimetres."""
    return f"{metres * 1000:.4g} mm"


def nothing_found() -> tuple[NDArray[np.intp], Floats]:
    """Return the result of a finder for an image without a board."""
    return np.zeros(0, np.intp), np.zeros((0, 2))
