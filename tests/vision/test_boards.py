"""Boards of several markers, from their file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from roverlink.runtime.core.errors import SetupError
from roverlink.vision import MarkerSet
from roverlink.vision.markers.boards import read_boards

_GATE = """\
boards:
  gate:
    side: 0.1
    markers:
      20: {position: [-0.2, 0, 0], rpy: [0, 0, 0]}
      21: {position: [0.2, 0, 0], rpy: [0, 0, 90], side: 0.2}
"""


def test_the_corners_are_where_the_file_says(tmp_path: Path) -> None:
    """A marker's centre is at its position, its axes are turned, and its side is its own or the board's."""
    path = tmp_path / "boards.yaml"
    path.write_text(_GATE)
    (gate,) = read_boards(path)
    assert gate.name == "gate"
    assert gate.corners[20] == pytest.approx(
        np.array([[-0.25, 0.05, 0], [-0.15, 0.05, 0], [-0.15, -0.05, 0], [-0.25, -0.05, 0]])
    )
    # turned left by a quarter, the upper left corner is the lower left one
    assert gate.corners[21] == pytest.approx(np.array([[0.1, -0.1, 0], [0.1, 0.1, 0], [0.3, 0.1, 0], [0.3, -0.1, 0]]))
    markers = MarkerSet(boards=(gate,))
    assert [markers.is_target(one) for one in ("gate", 20, 7, "wall", 250)] == [True, False, True, False, False]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("boards: {}", "no boards found"),
        ("gates: {}", "unknown key 'gates'; did you mean|unknown key 'gates'; known: boards"),
        ("boards: {7: {}}", "board 7: the name of a board must not be a number"),
        ("boards: {gate: {}}", r":1:16: board gate has no markers"),
        ("boards: {gate: {markers: {}}}", "board gate has no markers"),
        ("boards: {gate: {markers: 3}}", r":1:26: board gate: markers is not a mapping"),
        ("boards: {gate: {markers: {a: {}}}}", "board gate: 'a' is not the number of a marker"),
        (_GATE.replace("21:", "20:"), r":6:7: the key 20 occurs twice"),
        (_GATE.replace("    side: 0.1\n", ""), r":4:11: board gate: marker 20 has no side, and the board"),
        (_GATE.replace("side: 0.1", "side: big"), r":3:11: board gate: side is big"),
        (_GATE.replace("side: 0.2", "side: -1"), r":6:58: board gate: marker 21: side is -1"),
        (_GATE.replace("position: [0.2, 0, 0], ", ""), r":6:11: board gate: marker 21 has no position"),
        (
            _GATE.replace("side: 0.1", "side: 1.0e-200"),
            r":3:5: board 'gate': the corners of marker 20 do not form a square",
        ),
        (
            _GATE.replace("side: 0.2", f"side: {'9' * 400}"),
            r":6:58: board gate: marker 21: side: 9+\.\.\. is too large",
        ),
        ("[", r":1:2: not valid YAML"),
    ],
)
def test_a_board_that_cannot_be_is_told(tmp_path: Path, text: str, expected: str) -> None:
    """The file and the place in it are named."""
    path = tmp_path / "boards.yaml"
    path.write_text(text)
    with pytest.raises(SetupError, match=expected):
        read_boards(path)
