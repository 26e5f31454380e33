"""Arcs and the commands of the driving board, judged by a numerical integration of the rover's velocity."""

from __future__ import annotations

import cmath
import math
import struct
from collections.abc import Sequence

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from roverkit.driving.arcs import Arc, PlanarPose, arc_of_twist, arc_to
from roverkit.driving.board_commands import LARGEST_RADIUS_M, BoardCommand, BoardLimitError, DrivingBoard

Twist = tuple[float, float, float]
"""Velocity along x in m/s, angular velocity about z in rad/s, and the time in seconds for which both are constant."""

_STEPS = 200
_speeds = st.floats(0.01, 2) | st.floats(-2, -0.01)
_turns = st.just(0.0) | st.floats(-2, 2) | st.floats(-1e-9, 1e-9) | st.floats(-1e-4, 1e-4)
_twists = st.tuples(_speeds, _turns, st.floats(0.01, 5))
_numbers = st.floats(-20, 20)


def _driven(twists: Sequence[Twist]) -> PlanarPose:
    """The pose after velocities, one after the other: Simpson's rule over short steps in the complex plane."""
    position, yaw = 0j, 0.0
    for linear, angular, duration in twists:
        step = duration / _STEPS
        for _ in range(_STEPS):
            begin, middle, end = (cmath.exp(1j * (yaw + angular * step * part)) for part in (0, 0.5, 1))
            position += linear * step * (begin + 4 * middle + end) / 6
            yaw += angular * step
    return PlanarPose(position.real, position.imag, yaw)


def _same(pose: PlanarPose, other: PlanarPose, tolerance: float = 1e-7) -> bool:
    return pose.distance_to(other) < tolerance and abs(pose.yaw - other.yaw) < tolerance


def _over_the_wire(command: BoardCommand) -> BoardCommand:
    """The command as the board gets it: in single precision."""
    return BoardCommand(*struct.unpack("<2f", struct.pack("<2f", command.distance_to_go, command.turning_radius)))


@pytest.mark.slow
@given(twist=_twists, straight_radius=st.sampled_from([0.0, 1e5, -1e7]))
def test_the_board_drives_the_velocity(twist: Twist, straight_radius: float) -> None:
    """The command that reaches the board is the arc of the velocity, to single precision."""
    linear, angular, duration = twist
    board = DrivingBoard(straight_radius=straight_radius)
    command = _over_the_wire(board.command(arc_of_twist(*twist)))
    assert math.copysign(1, command.distance_to_go) == math.copysign(1, linear)
    if 0 < abs(command.turning_radius) < 1e5:
        # positive is to the left: forwards, a turn to the left is counterclockwise
        assert math.copysign(1, command.turning_radius) == math.copysign(1, angular * linear)
    lost = 1e-5 + abs(linear * duration) ** 2 / (abs(straight_radius) or LARGEST_RADIUS_M)
    assert _same(board.arc(command).end, _driven([twist]), lost * max(1, abs(angular * duration)))


@pytest.mark.slow
@given(twist=_twists, smallest=st.floats(0.1, 3))
def test_no_radius_is_below_the_smallest_one(twist: Twist, smallest: float) -> None:
    """A tighter arc keeps its side and its length."""
    arc = arc_of_twist(*twist)
    board = DrivingBoard(smallest_radius=smallest)
    command = board.command(arc)
    assert command.turning_radius == 0 or abs(command.turning_radius) >= smallest * (1 - 1e-12)
    limited = board.drivable(arc)
    assert (limited.length, limited.curvature >= 0) == (arc.length, arc.curvature >= 0)
    assert limited == arc or abs(arc.curvature) * smallest > 1


@given(x=_numbers, y=_numbers)
def test_an_arc_leads_to_a_point(x: float, y: float) -> None:
    """It is the shorter way: with less than half a turn, and backwards if the point is behind the rover."""
    assume(math.hypot(x, y) > 1e-6)
    arc = arc_to(x, y)
    assert math.hypot(arc.end.x - x, arc.end.y - y) < 1e-9 * max(1, abs(arc.length)) + 1e-9
    assert abs(arc.turn) <= math.pi + 1e-9
    assert math.copysign(1, arc.length) == math.copysign(1, x)


def test_a_straight_line_has_the_radius_that_the_board_wants() -> None:
    """Zero by default; where the board wants a large radius, it and larger ones are straight."""
    straight = Arc(3.0, 0.0)
    assert DrivingBoard().command(straight) == BoardCommand(3.0, 0.0)
    board = DrivingBoard(straight_radius=10_000.1)
    assert board.command(straight) == BoardCommand(3.0, 10_000.1)
    assert board.arc(_over_the_wire(board.command(straight))) == straight
    assert board.command(Arc(3.0, -1e-5)) == BoardCommand(3.0, 10_000.1)
    assert board.arc(BoardCommand(3.0, 0.0)) == straight


def test_what_the_board_cannot_drive_is_an_error() -> None:
    """Backwards if it cannot, on the spot, and numbers that are none."""
    with pytest.raises(BoardLimitError, match="does not drive backwards"):
        DrivingBoard(reverses=False).command(Arc(-1.0, 0.0))
    for arc in (Arc(math.nan, 0.0), Arc(1.0, math.inf)):
        with pytest.raises(BoardLimitError, match="is no arc"):
            DrivingBoard().command(arc)
    for command in (BoardCommand(math.nan, 0.0), BoardCommand(1.0, -math.inf)):
        with pytest.raises(ValueError, match="cannot execute"):
            DrivingBoard().arc(command)
    with pytest.raises(ValueError, match="on the spot"):
        arc_of_twist(0.0, 1.0, 0.1)
    with pytest.raises(ValueError, match="to itself"):
        arc_to(0.0, 0.0)
