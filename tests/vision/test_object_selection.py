"""The object that the operator selects: visible, held, lost."""

from __future__ import annotations

import numpy as np
import pytest
from needs import NO_OPENCV

pytest.importorskip("cv2", reason=NO_OPENCV)

from roverlink.vision import Pose
from roverlink.vision.objects.location import Location
from roverlink.vision.objects.selection import KNOWN_NS, Scene, Selection, State

_S = 1_000_000_000
_BASE = Pose(np.eye(3), np.array([0.5, 0, 0]))
"""From the camera to the rover."""
_MAP = Pose(np.eye(3), np.array([10.0, 0, 0]))
"""From the camera to the field."""


def _scene(*numbers: int, to_map: Pose | None = _MAP) -> Scene:
    return Scene({one: Location(np.array([one, 0.0, 1.0]), np.eye(3) / 100) for one in numbers}, _BASE, to_map)


def test_a_visible_object_is_where_the_camera_sees_it() -> None:
    """In the frame of the rover and in that of the field."""
    selection = Selection(5 * _S)
    selection.see(_scene(3, 4), 0)
    assert selection.select(4, 0)
    selection.see(_scene(3, 4), _S)
    place = selection.place(_S, None)
    assert (selection.object, selection.state) == (4, State.VISIBLE)
    assert place.in_base
    assert place.in_map
    assert place.in_base.point == pytest.approx([4.5, 0, 1])
    assert place.in_map.point == pytest.approx([14, 0, 1])
    assert place.in_base.covariance == pytest.approx(np.eye(3) / 100)


def test_a_hidden_object_stays_on_the_field() -> None:
    """The rover drives on, the covariance grows, and after the time to hold it is lost."""
    selection = Selection(5 * _S)
    selection.see(_scene(3), 0)
    assert selection.select(3, 0)
    selection.see(_scene(), 2 * _S)
    assert selection.state is State.HELD
    place = selection.place(2 * _S, Pose(np.eye(3), np.array([-11.0, 0, 0])))
    assert place.in_base
    assert place.in_map
    assert place.in_map.point == pytest.approx([13, 0, 1])
    assert place.in_base.point == pytest.approx([2, 0, 1])
    assert np.diag(place.in_map.covariance) == pytest.approx([0.05] * 3)
    selection.update(5 * _S)
    assert selection.state is State.HELD
    selection.update(5 * _S + 1)
    assert selection.state is State.LOST


def test_without_the_field_a_hidden_object_stays_before_the_rover() -> None:
    """No position on the field is invented."""
    selection = Selection(5 * _S)
    selection.see(_scene(3, to_map=None), 0)
    assert selection.select(3, 0)
    place = selection.place(_S, None)
    assert place.in_base
    assert place.in_base.point == pytest.approx([3.5, 0, 1])
    assert place.in_map is None


def test_an_object_that_returns_in_time_is_visible_again() -> None:
    """But one that was lost needs another selection."""
    selection = Selection(5 * _S)
    selection.see(_scene(3), 0)
    assert selection.select(3, 0)
    selection.update(4 * _S)
    selection.see(_scene(3), 4 * _S)
    assert selection.state is State.VISIBLE
    selection.update(20 * _S)
    selection.see(_scene(3), 20 * _S)
    assert selection.state is State.LOST
    assert selection.select(3, 20 * _S)
    assert selection.state is State.VISIBLE


def test_an_unknown_object_is_refused() -> None:
    """The selection stays as it was; an object can be selected for a while after it was seen."""
    selection = Selection(60 * _S)
    selection.see(_scene(3), 0)
    assert selection.select(3, 0)
    assert not selection.select(4, 0)
    assert selection.object == 3
    selection.see(_scene(4), 1)
    selection.see(_scene(5), KNOWN_NS + 1)
    assert selection.known(KNOWN_NS + 1) == [4, 5]
    assert not selection.select(3, KNOWN_NS + 1)
    assert (selection.object, selection.state) == (3, State.HELD)
    assert selection.select(4, KNOWN_NS + 1)
    selection.clear()
    assert (selection.object, selection.state) == (None, State.NONE)


def test_memory_stays_flat() -> None:
    """Objects that nobody can select are forgotten."""
    selection = Selection(5 * _S)
    for number in range(1000):
        selection.see(_scene(number), number * _S)
    assert len(selection.known(999 * _S)) == 3
