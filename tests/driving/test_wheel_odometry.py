"""Odometry of a simulated rover: exact without faults, without jumps with faults, and with honest covariances."""

from __future__ import annotations

import itertools
import math
import random
import statistics
from collections.abc import Callable
from dataclasses import replace

import pytest
from faulty_link import IDEAL, Faults, FaultyLink
from hypothesis import given, settings
from hypothesis import strategies as st

from roverlink.drive.drive_parameters import PARAMETERS
from roverlink.driving.arcs import Arc
from roverlink.driving.board_commands import STOP, BoardCommand
from roverlink.driving.rover_model import RoverSettings
from roverlink.driving.wheel_odometry import OdometryEstimate, WheelOdometry

_REAL = RoverSettings(gps_period=10**12)
"""A rover that slips, with a gyroscope that has noise and a bias."""
_seeds = st.integers(0, 2**32)
_faults = st.builds(
    Faults,
    lost=st.sampled_from([0.0, 0.02, 0.1]),
    repeated=st.sampled_from([0.0, 0.05]),
    late=st.sampled_from([0.0, 0.05]),
    motors=st.booleans(),
)


def _arcs(link: FaultyLink, metres: float, backwards: bool = False, restarts: float = 0.0) -> int:
    """Drive arcs, most of which are replaced before their end; the number of times that the board restarted."""
    rng, count = link.rng, 0
    link.run(1)
    while link.model.rolled < metres:
        direction = -1 if backwards and rng.random() < 0.3 else 1
        link.command(BoardCommand(direction * rng.uniform(0.3, 4), rng.choice((0, 1, -1)) * rng.uniform(0.7, 8)))
        link.run(rng.uniform(0.2, 8))
        if rng.random() < restarts:
            link.model.restart_board()
            count += 1
    _stop(link)
    return count


def _stream(link: FaultyLink, metres: float) -> None:
    """Drive as a controller does: a command each 30 or 50 ms, far longer than the rover drives until the next one."""
    rng = link.rng
    link.run(1)
    while link.model.rolled < metres:
        radius, speed = rng.choice((0, 1, -1)) * rng.uniform(0.7, 8), rng.uniform(0.15, 0.5)
        for _ in range(rng.randrange(5, 60)):
            link.command(BoardCommand(0.4 * speed * rng.uniform(0.9, 1.1), radius))
            link.run(rng.choice((0.03, 0.05)))
        if rng.random() < 0.3:
            link.command(STOP)
            link.run(rng.uniform(0.1, 2))
    _stop(link)


def _stop(link: FaultyLink) -> None:
    for _ in range(5):  # one of them arrives
        link.command(STOP)
        link.run(0.2)
    link.run(1)


def _distance_error(link: FaultyLink) -> float:
    x, y, _ = link.error()
    return math.hypot(x, y)


def _steps(link: FaultyLink) -> list[tuple[float, float]]:
    """The seconds and the metres between successive estimates."""
    pairs = itertools.pairwise(link.estimates)
    return [((new.at - old.at) / 1e9, new.pose.distance_to(old.pose)) for old, new in pairs]


# --- without slip: the distance of the wheels ---------------------------------------------------------------------


@given(_seeds, _faults, st.booleans())
@settings(max_examples=8)
def test_replaced_arcs_and_a_bad_link_lose_no_distance(seed: int, faults: Faults, backwards: bool) -> None:
    """Nothing is lost or counted twice but what no report contains: the last moments on a replaced command."""
    link = FaultyLink(seed, faults)
    _arcs(link, 10, backwards)
    assert _distance_error(link) < 0.02 * link.model.rolled + 0.05
    # A step is what the rover drives in this time, or, after a late report, in the time that it was late.
    assert all(metres <= 0.55 * (seconds + faults.lateness) + 0.05 for seconds, metres in _steps(link))


@given(_seeds, st.sampled_from([Faults(), Faults(lost=0.02, repeated=0.02)]))
@settings(max_examples=5)
def test_a_stream_of_commands_gives_the_distance(seed: int, faults: Faults) -> None:
    """Although no two reports are about the same command, the motors tell how far the rover rolls between them."""
    link = FaultyLink(seed, faults)
    _stream(link, 6)
    assert _distance_error(link) < 0.05 * link.model.rolled + 0.15


@given(_seeds, st.sampled_from([0.0005, 0.005, 0.012]))
@settings(max_examples=5)
def test_a_stream_of_equal_commands_gives_the_distance(seed: int, delay: float) -> None:
    """At the rate of `roverlink drive`, whose commands do not differ while the velocity stays the same."""
    link = FaultyLink(seed, Faults(delay=delay))
    rate, _, _ = PARAMETERS["rate"]
    link.run(1)
    while link.model.rolled < 10:
        link.command(BoardCommand(0.16, 1.1))
        link.run(1 / float(rate))
    _stop(link)
    driven = sum(metres for _, metres in _steps(link))
    assert driven == pytest.approx(link.model.rolled, rel=0.04)


@given(_seeds, st.booleans())
@settings(max_examples=5)
def test_a_board_that_restarts_causes_no_jump(seed: int, motors: bool) -> None:
    """The arc that it has forgotten is not counted; in the second of silence, the rover may have driven 0.5 m."""
    link = FaultyLink(seed, Faults(motors=motors))
    restarts = _arcs(link, 8, restarts=0.3)
    assert _distance_error(link) < 0.02 * link.model.rolled + 0.05 + 0.5 * restarts
    assert all(metres <= 0.55 * seconds + 0.05 for seconds, metres in _steps(link))


def test_the_old_arc_does_not_count_for_the_new_one() -> None:
    """A report that is still about the old command is not read as progress on the new one."""
    link = FaultyLink(1, Faults(delay=0.009))
    link.run(1)
    for distance in (5.0, 0.5, 4.0, 3.9, 0.7):
        link.command(BoardCommand(distance, 0.0))
        link.run(1.0)
    _stop(link)
    assert _distance_error(link) < 0.03


def test_an_unknown_command_is_followed() -> None:
    """Odometry that starts, or loses its clock, in the middle of an arc counts from there, and the turn is measured."""
    link = FaultyLink(1, Faults())
    link.run(1)
    link.command(BoardCommand(8.0, 3.0))
    link.run(4)
    link.odometry, before = WheelOdometry(), link.model.pose
    link.run(6)
    driven = before.inverse() @ link.model.pose
    pose = link.estimates[-1].pose
    assert pose.distance_to(driven) < 0.03
    assert pose.yaw == pytest.approx(driven.yaw, abs=0.01)


def test_a_command_that_another_program_sends_is_adopted() -> None:
    """Two reports that agree are believed; the distance before them is not known."""
    link = FaultyLink(1, Faults())
    link.run(1)
    link.command(BoardCommand(2.0, 0.0))
    link.run(2)
    link.model.command(BoardCommand(30.0, 0.0))  # the odometry does not hear of it
    link.run(5)
    assert _distance_error(link) < 0.1


def test_a_clock_that_jumps_back_causes_no_jump() -> None:
    """A simulation that is started again begins at another time; the pose stays."""
    odometry = WheelOdometry()
    times = [*range(100, 120), *range(20, 40)]
    odometry.command(99 * 10**8, Arc(5.0, 0.0))
    steps = [odometry.progress(at * 10**8, 5.0 - 0.05 * number) for number, at in enumerate(times)]
    poses = [one.pose.x for one in steps if one]
    assert max(abs(new - old) for old, new in itertools.pairwise(poses)) < 0.06
    assert poses[-1] == pytest.approx(0.05 * (len(times) - 2), abs=0.06)


# --- the gyroscope ------------------------------------------------------------------------------------------------


def test_the_bias_is_learned_while_the_rover_stands() -> None:
    """The pose does not drift then, and a drive afterwards is straight."""
    link = FaultyLink(4, Faults(), replace(IDEAL, imu=replace(_REAL.imu, gyro_bias=0.02)))
    link.run(10)
    assert abs(link.estimates[-1].pose.yaw) < 0.01
    link.command(BoardCommand(20.0, 0.0))
    link.run(45)
    assert abs(link.error()[2]) < 0.03
    assert link.estimates[-1].yaw_rate == 0


def test_a_rover_that_is_carried_while_its_wheels_stand_turns() -> None:
    """A large angular velocity is no bias."""
    odometry = WheelOdometry()
    for step in range(500):
        at = step * 10**7
        odometry.angular_velocity(at, 0.5 if 200 <= step < 400 else 0.0)
        if step % 5 == 0:
            odometry.motors(at, 0.0)
            estimate = odometry.progress(at, 0.0)
    assert estimate is not None
    assert estimate.pose.yaw == pytest.approx(1.0, abs=0.05)


def test_without_a_gyroscope_the_steering_tells_the_turn() -> None:
    """The covariance is far larger; with the gyroscope back, the turn is measured again."""
    with_gyro, without = FaultyLink(2, Faults(), _REAL), FaultyLink(2, Faults(imu=False), _REAL)
    for link in (with_gyro, without):
        link.run(2)
        for radius in (3.0, -2.0, 0.0):
            link.command(BoardCommand(4.0, radius))
            link.run(10)
    assert with_gyro.odometry.uses_gyroscope
    assert not without.odometry.uses_gyroscope
    assert abs(without.error()[2]) < 4 * math.sqrt(without.estimates[-1].covariance[2][2])
    assert without.estimates[-1].covariance[2][2] > 20 * with_gyro.estimates[-1].covariance[2][2]
    without.faults = replace(without.faults, imu=True)
    before = without.estimates[-1].pose.yaw - without.model.pose.yaw
    without.command(BoardCommand(2.0, 1.0))
    without.run(6)
    assert without.odometry.uses_gyroscope
    assert without.error()[2] == pytest.approx(before, abs=0.05)


def test_readings_that_are_lost_make_the_turn_less_certain() -> None:
    """A gap of a tenth of a second is bridged."""

    def turned(lost: range, steps: int = 300) -> OdometryEstimate:
        odometry = WheelOdometry()
        odometry.command(0, Arc(10.0, 0.5))
        estimates = []
        for step in range(steps):
            at = step * 10**7
            if step not in lost:
                odometry.angular_velocity(at, 0.25)
            if step % 5 == 0:
                estimates.append(odometry.progress(at, 10.0 - 0.005 * step))
        found = estimates[-1]
        assert found is not None
        return found

    whole, gap = turned(range(0)), turned(range(100, 112))
    assert gap.pose.yaw == pytest.approx(whole.pose.yaw, abs=0.01)
    assert gap.covariance[2][2] > whole.covariance[2][2]
    assert gap.yaw_rate_variance == whole.yaw_rate_variance
    assert turned(range(100, 112), 111).yaw_rate_variance > 10 * whole.yaw_rate_variance


def test_silence_makes_the_position_uncertain() -> None:
    """A rover that was driving may have driven on; one that stood has not."""
    link = FaultyLink(1, Faults())
    link.run(2)
    now = link.model.now
    still = link.odometry.silent(now + 10**9)
    assert still is not None
    assert still.covariance[0][0] < 1e-6
    link.command(BoardCommand(3.0, 0.0))
    link.run(3)
    silent = link.odometry.silent(link.model.now + 10**9)
    assert silent is not None
    assert silent.covariance[0][0] > 0.4**2
    assert silent.speed_variance > 0.2**2
    assert silent.pose == link.estimates[-1].pose
    assert WheelOdometry().silent(0) is None


# --- with slip: the covariance ------------------------------------------------------------------------------------


def _hundred_metres(link: FaultyLink) -> None:
    _arcs(link, 100, backwards=True)


def _hundred_metres_streamed(link: FaultyLink) -> None:
    _stream(link, 100)


def _straight(link: FaultyLink) -> None:
    link.run(10)  # the bias of the gyroscope decides about the end of a straight line
    link.command(BoardCommand(100.0, 0.0))
    link.run(205)


def _normalized_error(link: FaultyLink) -> float:
    """The squared error of x, y and yaw over its covariance: chi squared with 3 degrees of freedom."""
    np = pytest.importorskip("numpy")
    error = np.array(link.error())
    return float(error @ np.linalg.solve(np.array(link.estimates[-1].covariance), error))


def _band(runs: int, freedom: int) -> tuple[float, float]:
    """The interval of a mean of chi-squared values that holds 99.9 % of the means (Wilson and Hilferty, 1931)."""
    total = runs * freedom
    low, high = (total * (1 - 2 / (9 * total) + sign * 3.29 * math.sqrt(2 / (9 * total))) ** 3 for sign in (-1, 1))
    return low / runs, high / runs


def test_the_error_is_as_large_as_the_covariance_says() -> None:
    """The mean normalized error of short drives is within the band of chance."""
    errors = []
    for seed in range(15):
        link = FaultyLink(seed, Faults(), _REAL)
        rng = random.Random(seed)  # noqa: S311  # repeatable, not secret
        link.run(2)
        for _ in range(2):
            link.command(BoardCommand(rng.uniform(2, 4), rng.choice((0, 2, -2))))
            link.run(10)
        errors.append(_normalized_error(link))
    low, high = _band(len(errors), 3)
    assert low < statistics.fmean(errors) < high


@pytest.mark.slow
@pytest.mark.parametrize(
    "drive", [_straight, _hundred_metres, _hundred_metres_streamed], ids=["straight", "arcs", "stream"]
)
def test_a_hundred_metres_with_slip(drive: Callable[[FaultyLink], None]) -> None:
    """Of 100 drives, 95 drift less than 3 % of the way; the mean normalized error is within the band of chance."""
    drifts, errors = [], []
    for seed in range(100):
        link = FaultyLink(seed, Faults(), _REAL)
        drive(link)
        drifts.append(_distance_error(link) / link.model.rolled)
        errors.append(_normalized_error(link))
    low, high = _band(len(errors), 3)
    print(
        f"drift: mean {statistics.fmean(drifts):.2%}, p95 {sorted(drifts)[94]:.2%}, largest {max(drifts):.2%}; "
        f"normalized error {statistics.fmean(errors):.2f} (band {low:.2f} to {high:.2f})"
    )
    assert sorted(drifts)[94] < 0.03
    assert low < statistics.fmean(errors) < high
