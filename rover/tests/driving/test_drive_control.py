"""The control of the rover: what it sends, and when it sends nothing."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule
from roverkit.driving.arcs import PlanarPose
from roverkit.driving.board_commands import STOP, BoardCommand, DrivingBoard
from roverkit.driving.drive_control import DriveControl, DriveSettings, Localization, State, Status
from roverkit.simulation.rover_model import RoverModel

_TICK_S = 0.05
_SETTINGS = DriveSettings(DrivingBoard(smallest_radius=0.5), speed=1.0, period=0.05)
_AT_ONCE = replace(_SETTINGS, acceleration=1e9)  # Settings with which the rover has the wanted speed at once


class _Rover:
    """A control with a clock that the test moves, and what it has sent and said."""

    def __init__(self, settings: DriveSettings = _SETTINGS, automatic: bool = True) -> None:
        self.settings, self.said, self.now = settings, list[str](), 10**12
        self.control = DriveControl(lambda: self.settings, self.said.append)
        self.automatic = automatic
        self.localized: tuple[PlanarPose, str, float] | None = None
        self.speed: float | None = None
        self.tick(0)

    def tick(self, seconds: float = _TICK_S) -> BoardCommand | None:
        """What is sent after a while; the basestation and the localization go on as before."""
        self.now += round(seconds * 1e9)
        if self.automatic:
            self.control.set_mode(True, self.now)
        if self.localized:
            pose, frame, deviation = self.localized
            self.control.localize(Localization(pose, frame, self.now, deviation, self.speed), self.now)
        return self.control.step(self.now)

    def ticks(self, count: int) -> list[BoardCommand | None]:
        return [self.tick() for _ in range(count)]

    def drive(self, linear: float, angular: float = 0.0) -> BoardCommand | None:
        self.control.drive(linear, angular, self.now)
        return self.control.step(self.now)

    def drive_on(self, linear: float, angular: float, ticks: int) -> list[BoardCommand | None]:
        sent = []
        for _ in range(ticks):
            self.control.drive(linear, angular, self.now)
            sent.append(self.tick())
        return sent

    def follow(self, *points: tuple[float, float]) -> BoardCommand | None:
        self.control.follow(points, "map", self.now)
        return self.tick()


_AHEAD = (0.0, 0.0), (9.0, 0.0)  # A path
_HERE = PlanarPose(), "map", 0.1


def _distances(sent: Iterable[BoardCommand | None]) -> list[float]:
    return [command.distance_to_go for command in sent if command is not None]


_twists = st.tuples(st.floats(-1, -0.02) | st.floats(0.02, 1), st.floats(-1, 1), st.integers(1, 8))


@pytest.mark.slow
@given(twists=st.lists(_twists, max_size=4))
def test_a_board_that_keeps_up_drives_the_velocities(twists: list[tuple[float, float, int]]) -> None:
    """Each command replaces the one before in the middle of its arc; the rover's way is the one of the velocities."""
    rover = _Rover(replace(_AT_ONCE, board=DrivingBoard()))
    pose, position, yaw, before = PlanarPose(), 0j, 0.0, 0.0
    for linear, angular, ticks in twists:
        for command in rover.drive_on(linear, angular, ticks):
            assert command is not None
            if linear * before < 0:  # it stands before it drives in the other direction
                assert command.distance_to_go == 0
                before = 0.0
                continue
            # The board drives the distance in the time for which the command is enough.
            arc = rover.settings.board.arc(command)
            pose = pose @ arc.shortened(abs(arc.length) * _TICK_S / rover.settings.horizon).end
            step = _TICK_S / 4
            for _ in range(4):
                position += linear * step * cmath.exp(1j * (yaw + angular * step / 2))
                yaw += angular * step
            before = linear
    assert pose.x + 1j * pose.y == pytest.approx(position, abs=1e-3)
    assert pose.yaw == pytest.approx(yaw, abs=1e-6)


@pytest.mark.slow
@given(linear=st.floats(-1, 1), acceleration=st.floats(0.2, 3))
def test_the_speed_changes_with_the_largest_acceleration(linear: float, acceleration: float) -> None:
    """A command is the distance that the rover drives in the time for which it is enough, while it accelerates."""
    rover = _Rover(replace(_SETTINGS, acceleration=acceleration))

    def driven(seconds: float) -> float:
        ramp = min(seconds, abs(linear) / acceleration)
        return acceleration * ramp**2 / 2 + abs(linear) * (seconds - ramp)

    for tick, distance in enumerate(_distances(rover.drive_on(linear, 0, 40)), start=1):
        expected = driven(tick * _TICK_S + rover.settings.horizon) - driven(tick * _TICK_S)
        assert distance == pytest.approx(math.copysign(expected, linear))


def test_the_rover_stands_before_it_drives_in_the_other_direction() -> None:
    """It brakes on the arc that it drives."""
    rover = _Rover()
    rover.drive_on(0.5, 0.5, 40)
    sent = [command for command in rover.drive_on(-0.5, 0, 60) if command]
    distances = _distances(sent)
    assert distances == sorted(distances, reverse=True)
    assert distances[0] > 0.05
    assert distances[-1] == pytest.approx(-0.5 * rover.settings.horizon)
    assert [one.turning_radius for one in sent] == [1.0 if one.distance_to_go >= 0 else 0.0 for one in sent]
    sent = rover.drive_on(0, 0, 40)
    assert (_distances(sent)[-1], len(_distances(sent))) == (0, 40)  # so that a lost command does not matter


def test_a_board_that_is_too_fast_gets_less() -> None:
    """A board chooses its speed by itself. The measured speed is fed back, so that its mean is the wanted one."""
    rover = _Rover()
    rover.speed, left, driven = 0.0, 0.0, []
    for number in range(400):
        rover.localized = (PlanarPose(), "map", 0.0) if number % 2 else None  # a speed counts until the next one
        rover.control.drive(0.2, 0.0, rover.now)
        command = rover.tick()
        left = command.distance_to_go if command else left
        step = min(0.6 * _TICK_S, left)  # it drives as fast as it can until the distance is gone
        left -= step
        driven.append(step)
        rover.speed = step / _TICK_S
    assert sum(driven[100:]) / len(driven[100:]) / _TICK_S == pytest.approx(0.2, rel=0.05)
    assert all(0 <= one <= 2 * 0.2 * rover.settings.horizon + 1e-9 for one in _distances([rover.tick()]))


def test_a_start_is_hardly_too_fast() -> None:
    """While the rover accelerates, the distance is not made longer, although the rover is slower than it is to be."""
    rover, model, fastest = _Rover(DriveSettings()), RoverModel(1), 0.0
    for _ in range(60):
        rover.localized, rover.speed = _HERE, model.speed
        rover.control.drive(0.3, 0.0, rover.now)
        if command := rover.tick():
            model.command(command)
        model.advance(_TICK_S)
        fastest = max(fastest, model.speed)
    assert 0.29 < fastest < 1.1 * 0.3


def test_manual_is_one_stop_and_then_silence() -> None:
    """So that the commands of the person who drives are not overwritten. What was wanted before is forgotten."""
    rover = _Rover()
    rover.control.set_mode(False, rover.now)
    assert rover.control.step(rover.now) is None  # it stands: the person who drives may have begun already
    rover.tick()
    rover.drive_on(0.5, 0, 3)
    rover.automatic = False
    rover.control.set_mode(False, rover.now)
    assert rover.control.step(rover.now) == STOP
    assert rover.drive_on(0.5, 0, 20) == [None] * 20
    assert rover.control.status.state is State.MANUAL
    rover.automatic = True
    assert (rover.tick(), rover.control.status.state) == (None, State.IDLE)
    assert rover.drive(0.5) is not None


def test_a_silent_basestation_is_manual() -> None:
    """The rover stops within the time, and a path does not go on when the link is back."""
    rover = _Rover()
    rover.localized = _HERE
    assert rover.follow(*_AHEAD) is not None
    rover.automatic = False
    sent = rover.ticks(30)
    assert None not in sent[:19]
    assert sent.index(STOP) in (19, 20)
    assert sent[21:] == [None] * 9
    assert rover.control.status.reason.startswith("no control_mode for 1.")
    rover.automatic = True
    assert (rover.tick(), rover.control.status.state) == (None, State.IDLE)


def test_velocities_that_end_stop_the_rover() -> None:
    """One stop, and then silence, in which the bridge's deadman takes over."""
    rover = _Rover()
    rover.drive_on(0.5, 0.1, 3)
    sent = rover.ticks(15)
    assert sent.index(STOP) in (9, 10)
    assert sent[11:] == [None] * 4
    assert rover.control.status == Status(State.IDLE, "no velocity for 0.5 s")


@pytest.mark.parametrize(
    ("linear", "angular", "reason"),
    [
        (0.0, 0.5, "the message of the driving board has no turn on the spot; drive an arc"),
        (-0.2, 0.0, "the driving board does not drive backwards; if it does, set the parameter reverse"),
        (math.nan, 0.0, "it is not a number"),
        (0.2, math.inf, "it is not a number"),
        (5e-324, 1.0, "5e-324 m with the curvature inf/m is no arc"),
    ],
)
def test_a_velocity_that_cannot_be_driven_stops_the_rover(linear: float, angular: float, reason: str) -> None:
    """The user is told once, and the state has the reason until another velocity comes."""
    rover = _Rover(replace(_SETTINGS, board=DrivingBoard(smallest_radius=0.5, reverses=False)))
    rover.drive_on(0.5, 0, 3)
    assert rover.drive(linear, angular) == STOP
    rover.drive_on(linear, angular, 30)
    assert rover.said == [f"the velocity is refused: {reason}"]
    assert rover.control.status == Status(State.REFUSED, reason)
    assert rover.drive(0.5) is not None
    assert rover.control.status.state is State.DRIVING


def test_what_was_good_may_become_impossible_in_mid_drive() -> None:
    """A parameter takes the reverse gear away."""
    rover = _Rover()
    rover.drive_on(-0.5, 0, 5)
    rover.settings = replace(_SETTINGS, board=DrivingBoard(smallest_radius=0.5, reverses=False))
    assert rover.tick() == STOP
    assert rover.control.status == Status(State.REFUSED, "the driving board does not drive backwards")


def test_limits_are_told_once_in_an_episode() -> None:
    """Not for each message; again if it comes back after a while."""
    rover = _Rover()
    commands = rover.drive_on(2.0, -8.0, 60)
    assert commands[-1] == BoardCommand(pytest.approx(1.0 * rover.settings.horizon), -0.5)  # type: ignore[arg-type]
    assert rover.said == [
        "velocities are limited to the parameter speed, 1 m/s",
        "turns are limited to the parameter smallest_radius, 0.5 m",
    ]
    rover.drive_on(0.5, 0, 120)
    rover.drive_on(0.5, 8, 20)
    assert len(rover.said) == 3


def test_velocities_need_the_pose_if_a_parameter_says_so() -> None:
    """The same loss stops them."""
    rover = _Rover(replace(_SETTINGS, velocity_needs_pose=True))
    assert (rover.drive(0.5), rover.control.status.state) == (None, State.WAITING)
    rover.localized = PlanarPose(), "odom", 0.1
    assert rover.tick() is not None


def test_a_velocity_takes_over_from_a_path_and_a_path_from_velocities() -> None:
    """The newest one counts. An empty path ends the one before."""
    rover = _Rover()
    rover.localized = _HERE
    rover.follow(*_AHEAD)
    assert rover.drive(0.3) is not None
    assert rover.control.status.state is State.DRIVING
    assert rover.said == ["the path is abandoned, because a velocity came"]
    rover.follow(*_AHEAD)
    assert rover.control.status.state is State.FOLLOWING
    assert (rover.follow(), rover.control.status.state) == (STOP, State.IDLE)


def test_what_is_no_path_is_refused_and_none_is_taken_in_manual_mode() -> None:
    """The user is told both."""
    rover = _Rover()
    rover.control.follow([(0, math.nan)], "map", rover.now)
    rover.control.set_mode(False, rover.now)
    rover.control.follow([(0, 0)], "map", rover.now)
    assert rover.said == [
        "the path is refused: the path has a position that is not a number, or not on Earth",
        "the path is ignored, because the mode is manual",
    ]


class _AnyCourse(RuleBasedStateMachine):
    """Events in any order: what the control promises holds all the time."""

    def __init__(self) -> None:
        super().__init__()
        self.settings = DriveSettings(DrivingBoard(0.7, reverses=False), speed=0.8, period=0.05)
        self.control = DriveControl(lambda: self.settings, lambda _: None)
        self.now = self.mode_at = self.velocity_at = self.pose_at = 10**12
        self.automatic = self.path = self.moves = False
        self.sent: BoardCommand | None = None

    def _step(self) -> None:
        self.sent = self.control.step(self.now)
        if self.sent is not None:
            assert self.automatic or (self.moves and self.sent == STOP)
            self.moves = self.sent.distance_to_go != 0

    @rule(automatic=st.booleans())
    def tell_the_mode(self, automatic: bool) -> None:
        if automatic != self.automatic:
            self.path = False
        self.automatic, self.mode_at = automatic, self.now
        self.control.set_mode(automatic, self.now)
        self._step()

    @rule(linear=st.floats(-2, 2) | st.just(math.nan), angular=st.floats(-9, 9))
    def drive(self, linear: float, angular: float) -> None:
        self.velocity_at, self.path = self.now, False
        self.control.drive(linear, angular, self.now)
        self._step()

    @rule(points=st.lists(st.tuples(st.floats(-5, 5), st.floats(-5, 5)), max_size=5))
    def follow(self, points: list[tuple[float, float]]) -> None:
        self.path = self.automatic and bool(points)
        self.control.follow(points, "map", self.now)
        self._step()

    @rule(x=st.floats(-5, 5), y=st.floats(-5, 5), yaw=st.floats(-3, 3), speed=st.none() | st.floats(-1, 1))
    def localize(self, x: float, y: float, yaw: float, speed: float | None) -> None:
        self.pose_at = self.now
        self.control.localize(Localization(PlanarPose(x, y, yaw), "map", self.now, 0.1, speed), self.now)

    @rule(seconds=st.floats(0, 1.5))
    def wait(self, seconds: float) -> None:
        self.now += round(seconds * 1e9)
        if self.now - self.mode_at > 1e9:
            self.automatic = self.path = False
        self._step()

    @invariant()
    def commands_are_within_the_limits(self) -> None:
        """A command that moves has a cause that is fresh, and a board without reverse gear can drive it."""
        if self.sent is None or self.sent.distance_to_go == 0:
            return
        assert 0 < self.sent.distance_to_go <= 2 * 0.8 * self.settings.horizon + 1e-9
        assert self.sent.turning_radius == 0 or abs(self.sent.turning_radius) >= 0.7 - 1e-9
        last = self.pose_at if self.path else self.velocity_at
        assert self.now - last <= 0.5e9
        assert self.now - self.mode_at <= 1e9


test_whatever_happens = _AnyCourse.TestCase
test_whatever_happens.settings = settings(max_examples=40)
test_whatever_happens.pytestmark = [pytest.mark.slow]
