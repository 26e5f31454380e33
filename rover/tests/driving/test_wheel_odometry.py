"""Odometry of a simulated rover: exact without faults, without jumps with faults, and with honest covariances."""

from __future__ import annotations

import heapq
import itertools
import math
import random
import statistics
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeVar

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from roverkit.driving.arcs import Arc, PlanarPose
from roverkit.driving.board_commands import STOP, BoardCommand
from roverkit.gating import Reasons
from roverkit.odometry.tape_test import TapeTest
from roverkit.odometry.wheel_odometry import OdometryEstimate, WheelOdometry
from roverkit.simulation.rover_model import STEP_NS, MotorReport, ProgressReport, RoverModel, RoverSettings
from roverkit.simulation.rover_sensors import ImuReading, ImuSettings

IDEAL = RoverSettings(
    slip=0.0,
    mean_slip=0.0,
    side_slip=0.0,
    yaw_slip=0.0,
    imu=ImuSettings(gyro_noise=0.0, gyro_scale=0.0, gyro_bias=0.0, gyro_bias_walk=0.0),
    gps_period=10**12,
)
"""A rover of which the odometry may know everything: no slip, and a gyroscope without errors."""


T = TypeVar("T")
_SENT_NS = STEP_NS - 500_000
"""Time in a step of the model at which commands are sent: half a millisecond before the board can receive them."""


@dataclass(frozen=True, slots=True)
class Faults:
    """Probabilities of faults of a link, and times in seconds."""

    lost: float = 0.0
    repeated: float = 0.0
    late: float = 0.0
    """Probability that a report is `lateness` later, so that newer ones overtake it."""
    lateness: float = 0.12
    delay: float = 0.0005
    """Usual longest delay."""
    least_delay: float = 0.0
    step: float = 0.0
    """Step in metres to which the board rounds its reports; 0 for none."""
    motors: bool = True
    imu: bool = True
    odometer: bool = False
    """True if the board reports its odometer and the numbers of commands."""
    bias: float = 0.0
    """Bias of the gyroscope in rad/s."""
    sign: int = 1
    """-1 for an IMU that is mounted upside down."""


class FaultyLink:
    """A simulated rover and its odometry, between which commands and reports are delayed, lost, repeated, reordered."""

    def __init__(self, seed: int, faults: Faults, settings: RoverSettings = IDEAL) -> None:
        self.model, self.faults = RoverModel(seed, settings), faults
        self.said: list[str] = []
        self.odometry = WheelOdometry(reasons=Reasons(self.said.append), has_odometer=faults.odometer)
        self.rng = random.Random(seed)  # noqa: S311  # repeatable, not secret
        self.estimates: list[OdometryEstimate] = []
        self._commands: list[tuple[int, int, BoardCommand]] = []
        self._reports: list[tuple[int, int, ProgressReport | MotorReport | ImuReading]] = []
        self._count = self._number = 0

    def command(self, command: BoardCommand) -> None:
        """Send a command, as it is seen on the topic now; it arrives at the board somewhat later, or never."""
        board, now = self.model.settings.board, self.model.now + _SENT_NS
        self._number += self.faults.odometer
        command = replace(command, command_number=self._number)
        self.odometry.command(now, board.drivable(board.arc(command)), self._number)
        if self.rng.random() >= self.faults.lost:
            self._put(self._commands, now, command)

    def run(self, seconds: float) -> None:
        """Let time pass."""
        end = self.model.now + round(seconds * 1e9)
        while self.model.now < end:
            while self._commands and self._commands[0][0] <= self.model.now:
                self.model.command(heapq.heappop(self._commands)[2])
            for one in self.model.advance(STEP_NS / 1e9):
                if isinstance(one, (ProgressReport, MotorReport)):
                    self._transport(one)
                elif isinstance(one, ImuReading) and self.faults.imu:
                    self._put(self._reports, one.at, one)
            while self._reports and self._reports[0][0] < self.model.now + _SENT_NS:
                self._deliver(*heapq.heappop(self._reports)[::2])

    def error(self) -> tuple[float, float, float]:
        """The last estimate minus the truth, in the frame of the start: x, y in metres and yaw in radians."""
        pose, truth = self.estimates[-1].pose, self.model.pose
        return pose.x - truth.x, pose.y - truth.y, pose.yaw - truth.yaw

    def _transport(self, report: ProgressReport | MotorReport) -> None:
        if self.rng.random() < self.faults.lost:
            return
        if isinstance(report, ProgressReport) and (step := self.faults.step):
            report = replace(report, distance_left=round(report.distance_left / step) * step)
        for _ in range(2 if self.rng.random() < self.faults.repeated else 1):
            late = self.faults.lateness if self.rng.random() < self.faults.late else 0.0
            self._put(self._reports, report.at + round(late * 1e9), report)

    def _put(self, queue: list[tuple[int, int, T]], at: int, what: T) -> None:
        self._count += 1
        heapq.heappush(
            queue, (at + round(self.rng.uniform(self.faults.least_delay, self.faults.delay) * 1e9), self._count, what)
        )

    def _deliver(self, at: int, report: ProgressReport | MotorReport | ImuReading) -> None:
        if isinstance(report, ImuReading):
            self.odometry.angular_velocity(at, self.faults.sign * report.angular_velocity[2] + self.faults.bias)
        elif isinstance(report, MotorReport):
            if self.faults.motors:
                self.odometry.motors(at, (abs(report.left_rpm) + abs(report.right_rpm)) / 2)
        else:
            told = (report.odometer, report.command_number) if self.faults.odometer else ()
            if estimate := self.odometry.progress(at, report.distance_left, *told):
                self.estimates.append(estimate)


_REAL = RoverSettings(gps_period=10**12)  # A rover that slips, with a gyroscope that has noise and a bias
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


def _stream(link: FaultyLink, metres: float, periods: tuple[float, ...] = (0.03, 0.05)) -> None:
    """Drive as a controller does: the commands are far longer than the rover drives until the next one."""
    rng = link.rng
    link.run(1)
    while link.model.rolled < metres:
        radius, speed = rng.choice((0, 1, -1)) * rng.uniform(0.7, 8), rng.uniform(0.15, 0.5)
        for _ in range(rng.randrange(5, 60)):
            link.command(BoardCommand(0.4 * speed * rng.uniform(0.9, 1.1), radius))
            link.run(rng.choice(periods))
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


@pytest.mark.slow
@given(_seeds, _faults, st.booleans())
@settings(max_examples=5, derandomize=True)  # seed 102999 is off by 0.5 m, with a standard deviation of 0.6 m
def test_replaced_arcs_and_a_bad_link_lose_no_distance(seed: int, faults: Faults, backwards: bool) -> None:
    """Nothing is lost or counted twice but what no report contains: the last moments on a replaced command."""
    link = FaultyLink(seed, faults)
    _arcs(link, 10, backwards)
    assert _distance_error(link) < 0.02 * link.model.rolled + 0.05
    # A step is what the rover drives in this time, or, after a late report, in the time that it was late.
    assert all(metres <= 0.55 * (seconds + faults.lateness) + 0.05 for seconds, metres in _steps(link))


@pytest.mark.slow
@given(_seeds, st.sampled_from([Faults(), Faults(lost=0.02, repeated=0.02)]))
@settings(max_examples=3)
def test_a_stream_of_commands_gives_the_distance(seed: int, faults: Faults) -> None:
    """Although no two reports are about the same command, the motors tell how far the rover rolls between them."""
    link = FaultyLink(seed, faults)
    _stream(link, 6)
    assert _distance_error(link) < 0.05 * link.model.rolled + 0.15


@pytest.mark.slow
@given(_seeds, st.booleans())
@settings(max_examples=3)
def test_a_board_that_restarts_causes_no_jump(seed: int, motors: bool) -> None:
    """The arc that it has forgotten is not counted; in the second of silence, the rover may have driven 0.5 m."""
    link = FaultyLink(seed, Faults(motors=motors))
    restarts = _arcs(link, 8, restarts=0.3)
    assert _distance_error(link) < 0.02 * link.model.rolled + 0.05 + 0.5 * restarts
    assert all(metres <= 0.55 * seconds + 0.05 for seconds, metres in _steps(link))


@pytest.mark.slow
@given(_seeds, st.integers(0, 2))
@example(78, 2)  # the first report of the new start is no longer 0, and the old odometer is not far away
@settings(max_examples=5, deadline=None)
def test_with_an_odometer_the_distance_is_exact_over_a_bad_link(seed: int, restarts: int) -> None:
    """30 % of the commands and reports are lost, the others up to 200 ms late and in any order, some twice.

    Only what the rover rolls while its board starts again is estimated, and the covariance says so.
    """
    link = FaultyLink(seed, Faults(lost=0.3, repeated=0.1, delay=0.2, imu=False, odometer=True))
    link.run(1)
    for part in range(restarts + 1):
        for _ in range(40):  # as a controller does, forwards and backwards
            link.command(BoardCommand(link.rng.choice((1.0, 1.0, -0.6)) * link.rng.uniform(0.2, 1), 0.0))
            link.run(link.rng.choice((0.03, 0.1, 0.4)))
        if part < restarts:
            link.model.restart_board()
    _stop(link)
    assert link.model.rolled > 0.3
    deviation = math.sqrt(link.estimates[-1].covariance[0][0])
    assert abs(link.error()[0]) < 0.002 + min(3 * deviation, 0.4) * restarts


def test_the_number_of_a_command_tells_the_turn_without_an_imu() -> None:
    """Commands that never reach the board do not turn the rover."""
    link = FaultyLink(3, Faults(imu=False, odometer=True))
    link.command(BoardCommand(3.0, 2.0))
    link.run(2)
    link.faults = replace(link.faults, lost=1.0)
    link.command(BoardCommand(3.0, -1.0))
    link.faults = replace(link.faults, lost=0.0)
    link.run(8)
    assert link.error()[:2] == pytest.approx((0, 0), abs=0.1)


def test_an_odometer_that_begins_anywhere_again_causes_no_jump() -> None:
    """A single report that no rover can have driven is ignored; half a second of such reports is a new beginning."""
    odometry, seen = WheelOdometry(has_odometer=True), []
    for step in range(100):
        odometer = 0.02 * step + (700.0 if step >= 50 else 0) + (5.0 if step == 20 else 0)
        estimate = odometry.progress(step * 50_000_000, 1.0, odometer, 0)
        seen += [estimate.pose.x] if estimate else []
    assert odometry.ignored == 11
    assert seen[-1] == pytest.approx(0.02 * (99 - 11), abs=0.1)
    assert max(abs(new - old) for old, new in itertools.pairwise(seen)) < 0.1


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


@pytest.mark.slow
@pytest.mark.parametrize(("bias", "told"), [(0.004, 0), (0.055, 1), (-0.34, 1)])
def test_the_bias_is_learned_while_the_rover_stands(bias: float, told: int) -> None:
    """The pose does not drift then, a drive afterwards is straight, and a large bias is said."""
    link = FaultyLink(4, Faults(bias=bias))
    link.run(10)
    assert abs(link.estimates[-1].pose.yaw) < 0.01
    assert link.estimates[-1].yaw_rate == 0
    assert len([one for one in link.said if one.startswith("the bias of the gyroscope is larger")]) == told
    link.command(BoardCommand(4.0, 0.0))
    link.run(9)
    assert abs(link.error()[2]) < 0.01


@pytest.mark.parametrize(("rate", "rest"), [(0.5, 2), (0.04, 20)])
def test_a_rover_that_is_turned_while_its_wheels_stand_turns(rate: float, rest: int) -> None:
    """An angular velocity that the known bias does not explain is no bias."""
    said: list[str] = []
    odometry = WheelOdometry(reasons=Reasons(said.append))
    for step in range(100 * rest + 300):
        at = step * 10**7
        odometry.angular_velocity(at, rate if 0 <= step - 100 * rest < 200 else 0.0)
        if step % 5 == 0:
            odometry.motors(at, 0.0)
            estimate = odometry.progress(at, 0.0)
    assert estimate is not None
    assert estimate.pose.yaw == pytest.approx(2 * rate, abs=0.1 * rate)
    (told,) = said
    assert told.startswith("the rover turns while its wheels stand")


@pytest.mark.slow
def test_an_imu_that_is_mounted_upside_down_is_named() -> None:
    """Its turns are not those of the steering; of a right one, nothing is said."""
    for sign, count in ((1, 0), (-1, 1)):
        link = FaultyLink(3, Faults(sign=sign), _REAL)
        link.run(2)
        link.command(BoardCommand(4.0, 2.0))
        link.run(9)
        assert len([one for one in link.said if "upside down" in one]) == count


def test_drives_along_a_tape_tell_the_scale() -> None:
    """Each drive ends where the rover stands; the way back to the start does not count, if it is carried."""
    said: list[str] = []
    tape = TapeTest(4.0, lambda: 1.0, said.append)
    place = 0.0
    for reported in (4.2, 4.1, 4.15, 0.5):
        for part, speed in ((0.0, 0.0), (0.5, 0.5), (1.0, 0.0)):
            estimate = OdometryEstimate(0, PlanarPose(place + part * reported), [], speed, 0.0, 0.0, 0.0)
            tape.take(estimate)
        place += reported
    assert len(said) == 3
    assert said[0].startswith("4.200 m by odometry on a tape of 4 m; after 1 drives, distance_scale is 0.9524")
    assert said[2].endswith("distance_scale is 0.9639, mean_slip 0.0070, and slip 0.024")


@pytest.mark.slow
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
    assert [one for one in without.said if "no angular velocity" in one]
    pairs = itertools.pairwise(without.estimates)
    new = sum(later.yaw_rate_variance * ((later.at - one.at) / 1e9) ** 2 for one, later in pairs)
    assert new == pytest.approx(without.estimates[-1].covariance[2][2], rel=0.3)  # both tell the same about the turn
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
    still = link.odometry.silent(link.model.now + 10**9)
    assert still
    assert still.covariance[0][0] < 1e-6
    link.command(BoardCommand(3.0, 0.0))
    link.run(3)
    silent = link.odometry.silent(link.model.now + 10**9)
    assert silent is not None
    assert silent.covariance[0][0] > 0.4**2
    assert silent.speed_variance > 0.2**2
    assert silent.pose == link.estimates[-1].pose
    assert WheelOdometry().silent(0) is None


def _normalized_error(link: FaultyLink) -> float:
    """The squared error of x, y and yaw over its covariance: chi squared with 3 degrees of freedom."""
    np = pytest.importorskip("numpy")
    error = np.array(link.error())
    return float(error @ np.linalg.solve(np.array(link.estimates[-1].covariance), error))


@pytest.mark.slow
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
    assert 1.34 < statistics.fmean(errors) < 5.53  # 99.9 % of the means of 15 such values


def _straight(link: FaultyLink) -> None:
    link.run(10)  # the bias of the gyroscope decides about the end of a straight line
    link.command(BoardCommand(100.0, 0.0))
    link.run(205)


@pytest.mark.exhaustive
@pytest.mark.parametrize("drive", [_straight, lambda link: _arcs(link, 100, True), lambda link: _stream(link, 100)])
def test_a_hundred_metres_with_slip(drive: Callable[[FaultyLink], object]) -> None:
    """The figures of rover/docs/odometry.md: of 100 drives, 95 drift less than 5 %, and the covariance is honest."""
    drifts, errors = [], []
    for seed in range(100):
        link = FaultyLink(seed, Faults(), _REAL)
        drive(link)
        drifts.append(_distance_error(link) / link.model.rolled)
        errors.append(_normalized_error(link))
    print(f"drift: mean {statistics.fmean(drifts):.2%}, p95 {sorted(drifts)[94]:.2%}; {statistics.fmean(errors):.2f}")
    assert sorted(drifts)[94] < 0.05
    assert 2.26 < statistics.fmean(errors) < 3.87  # 99.9 % of the means of 100 such values


def _four_percent(link: FaultyLink) -> None:
    link.model._mean_slip = 0.04
    _arcs(link, 58, True)


def _three_thousandths(link: FaultyLink) -> None:
    link.model._imu._gyro_scale = 1.003
    _arcs(link, 58, True)


_SLOW_REPORTS = replace(_REAL, progress_period=100_000_000)


@pytest.mark.exhaustive
@pytest.mark.parametrize(
    ("faults", "settings", "drive", "most"),
    [
        (Faults(), _REAL, lambda link: _arcs(link, 58, True), 3.9),
        (Faults(), _REAL, _four_percent, 4.0),
        (Faults(), _REAL, _three_thousandths, 4.0),
        (Faults(), _SLOW_REPORTS, lambda link: _stream(link, 30, (0.1,)), 6.0),
        (Faults(delay=0.051, least_delay=0.05), _REAL, lambda link: _stream(link, 30, (0.1,)), 6.0),
        (Faults(step=0.01), _REAL, lambda link: _stream(link, 30, (0.1,)), 6.0),
    ],
    ids=["default", "mean slip", "scale", "slow reports", "delay", "coarse reports"],
)
def test_what_cannot_be_known_is_in_the_covariance(
    faults: Faults, settings: RoverSettings, drive: Callable[[FaultyLink], object], most: float
) -> None:
    """Errors that stay the same during a drive: the mean normalized error of 50 drives."""
    errors = []
    for seed in range(50):
        link = FaultyLink(seed, faults, settings)
        drive(link)
        errors.append(_normalized_error(link))
    print(f"{statistics.fmean(errors):.2f}")
    assert statistics.fmean(errors) < most
