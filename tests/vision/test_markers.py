"""Which markers there are."""

from __future__ import annotations

import numpy as np
import pytest

from roverlink.runtime.core.errors import SetupError
from roverlink.vision import Board, MarkerSet
from roverlink.vision.markers.marker_set import square

SHIFTED = square(0.1) + np.array([0.2, 0, 0])


def test_each_number_may_have_its_own_side() -> None:
    """The side of single numbers goes before the side of all."""
    markers = MarkerSet(side=0.05, sides={7: 0.15})
    assert np.ptp(markers.points(7), axis=0) == pytest.approx([0.15, 0.15, 0])
    assert np.ptp(markers.points(8), axis=0) == pytest.approx([0.05, 0.05, 0])


def test_a_board_s_markers_are_one_landmark() -> None:
    """They have the board's name; others their own number."""
    markers = MarkerSet(boards=(Board("gate", {1: square(0.1), 2: SHIFTED}),))
    assert [markers.target(number) for number in (1, 2, 3)] == ["gate", "gate", 3]
    assert markers.points(2) == pytest.approx(SHIFTED)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: MarkerSet(dictionary="DICT_5X5_205"), "DICT_5X5_250"),
        (lambda: MarkerSet(side=0), "positive"),
        (lambda: MarkerSet(sides={250: 0.1}), "0 to 249"),
        (lambda: MarkerSet(sides={3: -1.0}), "positive"),
        (lambda: Board("gate", {}), "no markers"),
        (lambda: Board("gate", {1: square(0.1) * [1, 2, 1]}), "do not form a square"),
        (lambda: Board("gate", {1: square(0.1)[:3]}), "do not form a square"),
        (lambda: MarkerSet(boards=(Board("a", {1: square(0.1)}), Board("b", {1: square(0.1)}))), "'a' and 'b'"),
        (lambda: MarkerSet(side=None).points(3), "marker 3"),
    ],
)
def test_what_cannot_be_is_refused(make: object, words: str) -> None:
    """The message names the number, the board or the nearest dictionary."""
    with pytest.raises(SetupError, match=words):
        make()
