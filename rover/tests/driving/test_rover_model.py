"""The model of a rover: it repeats what a seed gave, drives as its board may, and slips and measures as it says."""

from __future__ import annotations

import math
import statistics
from typing import TypeVar

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from roverkit.driving.arcs import Arc, PlanarPose
from roverkit.driving.board_commands import BoardCommand
from roverkit.driving.geodesy import Datum
from roverkit.simulation.rover_model import STEP_NS, Measurement, MotorReport, ProgressReport, RoverModel, RoverSettings
from roverkit.simulation.rover_sensors import GpsFix, ImuReading

_FIRM = RoverSettings(slip=0.0, mean_slip=0.0, side_slip=0.0, yaw_slip=0.0, steering_rate=math.inf)
"""A rover whose wheels do not slip."""
T = TypeVar("T")
_distances = st.floats(0.05, 5) | st.floats(-5, -0.05)
_radii = st.just(0.0) | st.floats(0.1, 20) | st.floats(-20, -0.1)
_commands = st.lists(st.tuples(st.builds(BoardCommand, _distances, _radii), st.floats(0.1, 2)), min_size=1, max_size=4)


def _of(kind: type[T], measured: list[Measurement]) -> list[T]:
    return [one for one in measured if isinstance(one, kind)]


def _left(measured: list[Measurement]) -> list[float]:
    return [one.distance_left for one in _of(ProgressReport, measured)]


@pytest.mark.slow
@given(st.integers(0, 2**32), _commands, st.integers(1, 7))
@settings(max_examples=10)
def test_a_seed_repeats_a_drive(seed: int, commands: list[tuple[BoardCommand, float]], pieces: int) -> None:
    """Into however many steps the caller divides the time; with another seed, everything differs."""

    def drive(divisor: int, seed: int = seed) -> list[Measurement]:
        model, measured = RoverModel(seed), list[Measurement]()
        for command, duration in commands:
            model.command(command)
            steps = round(duration * 1e9 / STEP_NS)
            for begin in range(0, steps, divisor):
                measured += model.advance(min(divisor, steps - begin) * STEP_NS / 1e9)
        return measured

    assert drive(pieces) == drive(1000) != drive(1000, seed + 1)


@pytest.mark.slow
@given(_distances, _radii)
@settings(max_examples=30)
def test_a_rover_that_does_not_slip_ends_at_the_end_of_its_arc(distance: float, radius: float) -> None:
    """A radius that is too small is limited to the smallest one."""
    model = RoverModel(1, _FIRM)
    model.command(BoardCommand(distance, radius))
    model.advance(abs(distance) / _FIRM.speed + 3)
    curvature = 0.0 if radius == 0 else math.copysign(min(1 / abs(radius), 2.0), radius)
    assert model.pose.distance_to(Arc(distance, curvature).end) < 1e-6
    assert model.pose.yaw == pytest.approx(distance * curvature, abs=1e-6)
    assert model.speed == 0


@pytest.mark.slow
@given(_commands)
@settings(max_examples=20)
def test_the_board_keeps_its_limits(commands: list[tuple[BoardCommand, float]]) -> None:
    """Speed, acceleration and curvature; and the distance left is what the wheels have not rolled yet."""
    limits = RoverSettings()
    model = RoverModel(1, limits)
    for command, duration in commands:
        model.command(command)
        start, rolled, speed = command.distance_to_go, 0.0, model.speed
        for _ in range(round(duration * 1e9 / STEP_NS)):
            left = _left(model.advance(STEP_NS / 1e9))
            rolled += model.speed * STEP_NS / 1e9
            assert abs(model.speed) <= limits.speed + 1e-9
            assert abs(model.speed - speed) <= limits.braking * STEP_NS / 1e9 + 1e-9
            assert abs(model.yaw_rate) <= 0.7 * (2.0 + 6 * limits.yaw_slip)
            assert all(one == pytest.approx(start - rolled, abs=1e-3) for one in left if one)
            speed = model.speed


def test_a_board_that_restarts_forgets_its_command() -> None:
    """It is silent for a while, hears no command, and then has nothing left; the IMU goes on."""
    model = RoverModel(1)
    model.command(BoardCommand(5.0, 0.0))
    model.advance(3)
    model.restart_board()
    silent = model.advance(RoverSettings().restart_time - STEP_NS / 1e9)
    model.command(BoardCommand(1.0, 0.0))
    assert {type(one) for one in silent} == {ImuReading, GpsFix}
    assert set(_left(model.advance(1))) == {0.0}
    assert model.speed == 0
    model.command(BoardCommand(1.0, 0.0))
    assert _left(model.advance(1))[-1] < 1


def test_the_motors_turn_as_the_rover_drives() -> None:
    """The outer wheels are faster, the steering turns into the arc, and a standing board is idle."""
    model = RoverModel(1, _FIRM)
    idle = _of(MotorReport, model.advance(1))[-1]
    model.command(BoardCommand(-3.0, 2.0))
    driving = _of(MotorReport, model.advance(2))[-1]
    circumference = 2 * math.pi * _FIRM.wheel_radius
    assert (idle.state.name, idle.left_rpm, driving.state.name) == ("IDLE", 0, "OPERATING")
    speeds = [rpm * circumference / 60 for rpm in (driving.left_rpm, driving.right_rpm)]
    assert speeds == pytest.approx([-0.5 * (1 - 0.3 / 2), -0.5 * (1 + 0.3 / 2)])
    assert driving.steering == pytest.approx(math.atan(0.4 / 2))
    for value in (math.nan, math.inf):
        with pytest.raises(ValueError, match="cannot execute"):
            model.command(BoardCommand(value, 0.0))


def test_the_imu_measures_the_motion() -> None:
    """The mean of its readings while the rover stands and turns; gravity points up (REP 145)."""
    model = RoverModel(3, _FIRM, PlanarPose(0, 0, math.pi / 2))
    standing = _of(ImuReading, model.advance(20))
    model.command(BoardCommand(20.0, 1.0))
    model.advance(3)
    before = model.pose.yaw
    turning = _of(ImuReading, model.advance(20))

    def mean(readings: list[ImuReading], kind: str, axis: int) -> float:
        return statistics.fmean(getattr(one, kind)[axis] for one in readings)

    bias = mean(standing, "angular_velocity", 2)
    assert 0 < abs(bias) < 0.02
    rate = mean(turning, "angular_velocity", 2) - bias
    assert rate == pytest.approx((model.pose.yaw - before) / 20, rel=4 * _FIRM.imu.gyro_scale)
    noise = statistics.pstdev(one.angular_velocity[2] for one in standing)
    assert noise == pytest.approx(_FIRM.imu.gyro_noise / math.sqrt(0.02), rel=0.15)
    assert mean(standing, "linear_acceleration", 2) == pytest.approx(9.81, abs=0.25)
    across = mean(turning, "linear_acceleration", 1) - mean(standing, "linear_acceleration", 1)
    assert across == pytest.approx(0.25, abs=0.01)
    # The rover heads north: the field is ahead.
    assert mean(standing, "magnetic_field", 0) == pytest.approx(20e-6, rel=0.02)
    assert abs(mean(standing, "magnetic_field", 1)) < 0.2e-6


@pytest.mark.slow
def test_the_gps_scatters_around_the_true_position() -> None:
    """Latitude and longitude come back as metres on the map; the course is clockwise from north."""
    fixes = _of(GpsFix, RoverModel(5, _FIRM, PlanarPose(30, -20, 0.0)).advance(100))
    datum, deviation = _FIRM.gps.datum, _FIRM.gps.deviation
    places = [datum.planar(one.latitude, one.longitude) for one in fixes]
    for values, truth in zip(zip(*places), (30, -20), strict=True):
        assert statistics.fmean(values) == pytest.approx(truth, abs=4 * deviation / math.sqrt(len(values)))
        assert statistics.pstdev(values) == pytest.approx(deviation, rel=0.15)
    assert fixes[0].heading == 90


@pytest.mark.parametrize(
    ("latitude", "north", "east"), [(0, 110.574, 111.320), (45, 111.132, 78.847), (-60, 111.412, 55.800)]
)
def test_positions_on_the_plane_are_those_of_the_ellipsoid(latitude: float, north: float, east: float) -> None:
    """A thousandth of a degree has the length of published tables (WGS 84), and the way back is the same."""
    datum = Datum(latitude, 179.0, 0.0)
    x, y = datum.planar(latitude + 1e-3, 179.001)
    assert (x, y) == (pytest.approx(east, abs=2e-2), pytest.approx(north, abs=2e-2))
    assert Datum(-16.5, 179.9999).planar(-16.5, -179.9999) == pytest.approx((21.4, 0), abs=0.1)
    assert datum.planar(*datum.geodetic(-700.0, 500.0)) == pytest.approx((-700, 500), abs=1e-6)
