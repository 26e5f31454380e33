"""``roverlink drive``: velocities, paths and the mode from topics, and commands for the driving board."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace
from typing import Any

import pytest
from node_in_memory import BEGAN, SECOND, NodeInMemory
from polling import wait_until
from roverkit.driving.drive_node import Driving
from roverkit.driving.drive_parameters import DriveParameters
from roverkit.driving.drive_rows import DriveRows

from generated.messages import BasestationControlMode, DrivingBoardMotorMessage
from generated.registry import REGISTRY
from roverlink.runtime import Qos
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces import Time
from roverlink.runtime.interfaces.geometry_msgs import Point, Pose, PoseStamped, Twist, TwistStamped, Vector3
from roverlink.runtime.interfaces.nav_msgs import Odometry, Path
from roverlink.runtime.interfaces.rosgraph_msgs import Clock
from roverlink.runtime.interfaces.std_msgs import Header, String
from roverlink.runtime.ros_time.headers import header_of

_PERIOD = SECOND // 20


def _twist(linear: float, angular: float = 0.0) -> Twist:
    return Twist(Vector3(linear), Vector3(0, 0, angular))


def _path(length: float = 5.0, frame: str = "map", stamp: int = 0) -> Path:
    header = header_of(stamp, frame)
    return Path(header, [PoseStamped(header, Pose(Point(x))) for x in (0.0, length)])


class _Drive(NodeInMemory):
    """The node with its commands and states."""

    def __init__(self, held: ExitStack) -> None:
        super().__init__(held, "drive", ["use_sim_time:=true", "rate:=20.0"], DriveParameters)
        self.driving = Driving(self.connection, DriveRows(REGISTRY), self.parameters, self.logger, as_json=False)
        self.sent = self.hear("/drive_motor", DrivingBoardMotorMessage)
        self._states = self.hear("/drive/state", String)
        self.driving.receive()

    @property
    def states(self) -> list[str]:
        """The states that were published."""
        return [one.data for one in self._states]

    def log_about(self, text: str) -> list[str]:
        """The lines of the log with a text, without the states."""
        return [one for one in self.log if text in one and one not in self.states]

    def tick(self, count: int = 1, automatic: bool = True) -> None:
        """Let time pass, in which the basestation repeats the mode."""
        for _ in range(count):
            self.pass_time(_PERIOD)
            if automatic:
                self.publish("/control_mode", BasestationControlMode(1))
            self.driving.tick()

    def drive(self, message: Message, count: int = 1) -> None:
        """Publish a velocity again and again."""
        for _ in range(count):
            if isinstance(message, TwistStamped) and message.header.stamp.sec:
                message = replace(message, header=header_of(self.now, message.header.frame_id))
            self.publish("/cmd_vel", message)
            self.tick()

    def localize(
        self, x: float = 0.0, child: str = "base_link", late: float = 0.0, uncertain: bool = False
    ) -> Odometry:
        """The pose of the rover; if it is late by all the time that there was, it has no stamp."""
        message = Odometry(header_of(self.now - round(late * SECOND) if late < 100 else 0, "map"), child)
        message.pose.pose.position.x = x
        if uncertain:  # x and y are correlated: 0.6 m in one direction, 0.1 m in the other
            xx, xy = (0.6**2 + 0.1**2) / 2, (0.6**2 - 0.1**2) / 2
            message.pose.covariance[0:2] = message.pose.covariance[7:5:-1] = [xx, xy]
        return message


@pytest.fixture
def drive() -> Iterator[_Drive]:
    """The node, which sends a command at each tick."""
    with ExitStack() as held:
        yield _Drive(held)


def test_a_path_is_followed_in_simulated_time(drive: _Drive) -> None:
    """To its end, with the poses of the localization; the states tell each step."""
    drive.tick(2)
    drive.publish("/path", _path(1.0, stamp=drive.now))
    drive.tick()
    x = 0.0
    for _ in range(200):
        drive.publish("/odometry/global", drive.localize(x))
        drive.tick()
        if not drive.states[-1].startswith("following"):
            break
        assert x + drive.sent[-1].distance_to_go <= 1 + 1e-6
        x += drive.sent[-1].distance_to_go / 8
    assert x == pytest.approx(0.9, abs=0.05)
    assert drive.sent[-1] == DrivingBoardMotorMessage()
    assert drive.states[-1].startswith("idle: the end of the path is reached, 0.")
    assert [one.partition(":")[0] for one in drive.states] == ["manual", "idle", "waiting", "following", "idle"]


def test_simulated_time_that_stands_still_ends_nothing(drive: _Drive) -> None:
    """A simulation that is paused is no lost link. When it is started again, the rover stops."""
    drive.drive(_twist(0.3), 4)
    before = len(drive.sent)
    for _ in range(100):
        drive.driving.tick()
    assert drive.states[-1] == "driving"
    assert len(drive.sent) == before
    drive.publish("/clock", Clock(Time.since_1970(SECOND)))
    drive.driving.tick()
    assert drive.sent[-1] == DrivingBoardMotorMessage()
    assert drive.states[-1] == "manual: the time has jumped back; waiting for control_mode"


_STAMPED = TwistStamped(Header(Time(1), "base_link"), _twist(0.3))


@pytest.mark.parametrize(
    ("message", "expected"),
    [
        (replace(_STAMPED, header=Header(Time(1), "odom")), "it is in the frame 'odom', not in 'base_link'"),
        (_twist(math.nan), "the velocity is refused: it is not a number"),
        (Odometry(), "no velocities are received: /cmd_vel has messages of the type nav_msgs/msg/Odometry"),
    ],
)
def test_velocities_that_cannot_be_used_are_told_once(drive: _Drive, message: Message, expected: str) -> None:
    """The rover does not move."""
    drive.drive(message, 50)
    (line,) = drive.log_about("velocit")
    assert expected in line
    assert drive.sent == []


def test_stamps_of_velocities_must_be_fresh(drive: _Drive) -> None:
    """Old ones, as from a queue, do not count, and neither do those of a clock that is ahead. No stamp is accepted."""
    drive.drive(_STAMPED, 3)
    assert drive.states[-1] == "driving"
    for seconds, reason in ((-0.6, "more than 0.5 s old"), (0.6, "in the future")):
        for _ in range(15):
            stamp = drive.now + round(seconds * SECOND)
            drive.publish("/cmd_vel", replace(_STAMPED, header=header_of(stamp, "base_link")))
            drive.tick()
        expected = f"ignoring a velocity: its stamp is {reason}; is the clock of its computer right?"
        assert drive.log.count(expected) == 1
        assert drive.states[-1] == "idle: no velocity for 0.5 s"
    drive.drive(TwistStamped(twist=_twist(0.3)), 2)
    assert drive.states[-1] == "driving"


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        (_path(stamp=BEGAN - 11 * SECOND), "ignoring a path: its stamp is more than 10 s old; is the clock of its"),
        (_path(frame="odom"), "the path is refused: the path is in the frame 'odom', but the pose is in 'map'"),
        (
            Path(header_of(0, "map"), [*_path().poses, *_path(frame="odom").poses]),
            "ignoring a path: it is in the frame 'map', but has poses in ['odom']",
        ),
    ],
)
def test_paths_that_cannot_be_used_are_told(drive: _Drive, path: Path, expected: str) -> None:
    """The rover does not move."""
    drive.tick()
    drive.publish("/path", path)
    drive.publish("/odometry/global", drive.localize())
    drive.tick(2)
    assert drive.log_about(expected)
    assert drive.sent == []


_NO_POSE = "waiting: no pose has come yet"


@pytest.mark.parametrize(
    ("change", "log", "state"),
    [
        ({"late": 0.6}, "", "waiting: the newest pose is more than 0.5 s old"),
        ({"child": "camera_link"}, "it is the pose of 'camera_link', not of 'base_link'", _NO_POSE),
        ({"late": -0.6}, "its stamp is in the future; is the clock of its", _NO_POSE),
        ({"late": 100.0}, "it has no stamp", _NO_POSE),
        ({"x": math.nan}, "it has a value that is not a number, or not on Earth", _NO_POSE),
        ({"uncertain": True}, "", "waiting: the position is uncertain by more than 0.5 m"),
    ],
)
def test_the_rover_waits_for_a_pose_that_it_can_use(
    drive: _Drive, change: dict[str, Any], log: str, state: str
) -> None:
    """The reason is in the state, and that of ignored messages in the log; a usable pose lets the rover go on."""
    drive.tick()
    drive.publish("/path", _path())
    for _ in range(5):
        drive.publish("/odometry/global", drive.localize(**change))
        drive.tick()
    assert drive.sent == []
    assert drive.states[-1] == state
    lines = drive.log_about("ignoring a pose: ")
    assert len(lines) == bool(log)
    assert log in "".join(lines)
    drive.publish("/odometry/global", drive.localize())
    drive.tick()
    assert drive.states[-1] == "following"


def test_damaged_messages_are_told(drive: _Drive) -> None:
    """One line for each topic."""
    drive.drive(_twist(0.3), 2)
    for topic in ("/control_mode", "/path", "/cmd_vel", "/odometry/global"):
        drive.middleware.publisher(topic, String, Qos()).publish([b"\0\1\0\0"])
    assert [one.partition(":")[0] for one in drive.log_about("ignoring")] == [
        *("ignoring a control_mode", "ignoring a path", "ignoring a velocity", "ignoring a pose")
    ]


def test_parameters_change_while_the_rover_drives(drive: _Drive) -> None:
    """The next command obeys them. What is not possible is refused with the reason."""
    drive.drive(_twist(0.4), 30)
    assert drive.sent[-1].distance_to_go == pytest.approx(0.16)
    drive.parameters.change({"speed": 0.2, "straight_radius": 1e5})
    drive.drive(_twist(0.4), 30)
    assert drive.sent[-1].distance_to_go == pytest.approx(0.08)
    assert drive.sent[-1].turning_radius == pytest.approx(1e5)
    for changes, reason in (
        ({"horizon": 0.05}, "it must be at least 2 / rate = 0.1 s, or the rover stops when one command is lost"),
        ({"speed": 0.0}, "the parameter 'speed' is 0.0; it must be above 0"),
        ({"smallest_radius": -1.0}, "the parameter 'smallest_radius' is -1.0; it must be 0 or more"),
        ({"acceleration": math.inf}, "the parameter 'acceleration' is inf; it must be above 0"),
    ):
        with pytest.raises(SetupError, match=reason):
            drive.parameters.change(changes)
    assert drive.parameters.meaning.control.speed == 0.2


def test_a_velocity_is_sent_at_once_only_if_it_differs(drive: _Drive) -> None:
    """Others wait until the next command is due, so that the board can report its progress before; so does the mode."""
    drive.drive(_twist(0.3, 0.15), 40)
    count = len(drive.sent)
    for speed, turn in ((0.3, 0.15), (0.31, 0.15), (0.3, 0.16)):
        drive.publish("/cmd_vel", _twist(speed, turn))
        drive.publish("/control_mode", BasestationControlMode(1))
    assert len(drive.sent) == count
    for speed, turn in ((0.25, 0.125), (0.25, -0.125), (0.0, 0.0)):
        count += 1
        drive.publish("/cmd_vel", _twist(speed, turn))
        wait_until(lambda count=count: len(drive.sent) == count, "a command")


def test_the_end_of_the_program_stops_the_rover(drive: _Drive) -> None:
    """Then nothing is sent any more, and the last state says so."""
    drive.drive(_twist(0.3), 3)
    drive.driving.close()
    assert drive.sent[-1] == DrivingBoardMotorMessage()
    assert drive.states[-1] == "manual: this program ends"
    count = len(drive.sent)
    drive.drive(_twist(0.3), 3)
    assert len(drive.sent) == count
