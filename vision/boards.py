"""Boards of several markers, each one landmark; read from `boards.yaml`.

    boards:
      gate:
        side: 0.15                                  # metres; the side of every marker that has none of its own
        markers:
          20: {position: [-0.2, 0, 0], rpy: [0, 0, 0]}
          21: {position: [0.2, 0, 0.1], rpy: [0, 90, 0], side: 0.1}

A marker's pose is that of its centre in the board's frame, as `vision.reading` has it.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from runtime.errors import SetupError
from vision.camera import Floats
from vision.markers import Board, square
from vision.reading import POSE, mapping, pose, read_yaml


def read_boards(path: Path) -> tuple[Board, ...]:
    """Read a file of boards. Raises `SetupError` for what is missing or cannot be."""
    boards = read_yaml(path, "boards", {"boards"}).get("boards")
    if not isinstance(boards, dict) or not boards:
        raise SetupError(f"{path} has no boards; see the example in the documentation")
    return tuple(_board(name, value, f"{path}: board {name}") for name, value in boards.items())


def _board(name: object, value: object, where: str) -> Board:
    if not isinstance(name, str):
        raise SetupError(f"{where}: a board's name is no number, for markers have those")
    given = mapping(value, where, {"side", "markers"})
    markers = given.get("markers")
    if not isinstance(markers, dict):
        raise SetupError(f"{where} has no markers")
    return Board(name, {_number(key, where): _corners(one, given, f"{where}: {key}") for key, one in markers.items()})


def _number(key: object, where: str) -> int:
    if isinstance(key, bool) or not isinstance(key, int):
        raise SetupError(f"{where}: {key!r} is no marker's number")
    return key


def _corners(value: object, board: dict[str, Any], where: str) -> Floats:
    """The corners (4, 3) of a marker in the board's frame."""
    given = mapping(value, where, {*POSE, "side"})
    side = given.get("side", board.get("side"))
    if isinstance(side, bool) or not isinstance(side, int | float) or not 0 < side < math.inf:
        raise SetupError(f"{where}: the side is {side!r}; it is a number of metres above 0, here or for the board")
    return pose(given, where).apply(square(side))
