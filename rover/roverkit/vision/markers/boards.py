"""Boards, read from `boards.yaml`. A board is a group of markers at known relative positions; it is one landmark.

    boards:
      gate:
        side: 0.15                                  # metres; the default of the markers below
        markers:
          20: {position: [-0.2, 0, 0], rpy: [0, 0, 0]}
          21: {position: [0.2, 0, 0.1], rpy: [0, 90, 0], side: 0.1}

The pose of a marker is that of its centre in the board's frame; `roverkit.vision.poses.pose_entries` has the format.
"""

from __future__ import annotations

import math
from pathlib import Path

from roverkit.vision.camera.camera_model import Floats
from roverkit.vision.markers.marker_set import Board, square
from roverkit.vision.poses.pose_entries import POSE, pose
from roverkit.vision.yaml_file import Item, read_file
from roverlink.runtime.core.errors import SetupError


def read_boards(path: Path) -> tuple[Board, ...]:
    """Read a file of boards. Raises `SetupError`, with line and column, for missing or impossible values."""
    whole = read_file(path, "boards")
    top = whole.known_entries({"boards"})
    boards = top["boards"].entries("board") if "boards" in top else {}
    if not boards:
        raise whole.error("no boards found under the key 'boards'; see the example in rover/docs/vision-reference.md")
    return tuple(_board(name, item) for name, item in boards.items())


def _board(name: object, item: Item) -> Board:
    if not isinstance(name, str):
        raise item.error(
            f"{item.name}: the name of a board must not be a number, because a number names a single marker"
        )
    entries = item.known_entries({"side", "markers"})
    markers = entries["markers"].entries(f"{item.name}: marker") if "markers" in entries else {}
    if not markers:
        raise item.error(f"{item.name} has no markers; list them under the key 'markers'")
    side = entries.get("side")
    corners = {_number(key, marker, item.name): _corners(marker, side) for key, marker in markers.items()}
    try:
        return Board(name, corners)
    except SetupError as error:
        raise item.error(str(error)) from error


def _number(key: object, marker: Item, board: str) -> int:
    if isinstance(key, bool) or not isinstance(key, int):
        raise marker.error(f"{board}: {key!r} is not the number of a marker, such as 20")
    return key


def _corners(marker: Item, side: Item | None) -> Floats:
    """Return the corners (4, 3) of a marker in the board's frame, in metres; `side` is the board's default side."""
    entries = marker.known_entries({*POSE, "side"})
    given = entries.get("side", side)
    if given is None:
        raise marker.error(
            f"{marker.name} has no side, and the board has no default side; add 'side' in metres to one of them"
        )
    return pose(marker, entries).apply(square(_metres(given)))


def _metres(side: Item) -> float:
    side.require(0 < side.number < math.inf, "a length in metres above 0")  # false for NaN too
    return side.number
