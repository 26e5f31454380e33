"""Boards of several markers, each one landmark; read from `boards.yaml`.

    boards:
      gate:
        side: 0.15                                  # metres; the side of every marker that has none of its own
        markers:
          20: {position: [-0.2, 0, 0], rpy: [0, 0, 0]}
          21: {position: [0.2, 0, 0.1], rpy: [0, 90, 0], side: 0.1}

A marker's pose is that of its centre in the board's frame, as `roverlink.vision.poses.pose_entries` has it.
"""

from __future__ import annotations

import math
from pathlib import Path

from roverlink.runtime.core.errors import SetupError
from roverlink.vision.camera.camera_model import Floats
from roverlink.vision.markers.marker_set import Board, square
from roverlink.vision.poses.pose_entries import POSE, pose
from roverlink.vision.yaml_file import Item, read_file


def read_boards(path: Path) -> tuple[Board, ...]:
    """Read a file of boards. Raises `SetupError`, with the place, for what is missing or cannot be."""
    whole = read_file(path, "boards")
    top = whole.known_entries({"boards"})
    boards = top["boards"].entries("board") if "boards" in top else {}
    if not boards:
        raise whole.error("there are no boards; see the example in the documentation")
    return tuple(_board(name, item) for name, item in boards.items())


def _board(name: object, item: Item) -> Board:
    if not isinstance(name, str):
        raise item.error(f"{item.name}: a board's name is no number, for markers have those")
    entries = item.known_entries({"side", "markers"})
    markers = entries["markers"].entries(f"{item.name}: marker") if "markers" in entries else {}
    if not markers:
        raise item.error(f"{item.name} has no markers")
    side = entries.get("side")
    corners = {_number(key, marker, item.name): _corners(marker, side) for key, marker in markers.items()}
    try:
        return Board(name, corners)
    except SetupError as error:
        raise item.error(str(error)) from error


def _number(key: object, marker: Item, board: str) -> int:
    if isinstance(key, bool) or not isinstance(key, int):
        raise marker.error(f"{board}: {key!r} is no marker's number")
    return key


def _corners(marker: Item, side: Item | None) -> Floats:
    """The corners (4, 3) of a marker in the board's frame; `side` is the board's."""
    entries = marker.known_entries({*POSE, "side"})
    given = entries.get("side", side)
    if given is None:
        raise marker.error(f"{marker.name} has no side, and neither has the board")
    return pose(marker, entries).apply(square(_metres(given)))


def _metres(side: Item) -> float:
    metres = side.number
    if not 0 < metres < math.inf:  # nan, too
        raise side.error(f"{side.name} is {side.said}; it is a number of metres above 0")
    return metres
