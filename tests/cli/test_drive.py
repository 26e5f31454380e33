"""``roverlink drive``: velocities, paths and the mode from topics, and commands for the driving board."""

from __future__ import annotations

import json
import logging
import math
import socket
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path as FilePath
from typing import Any

import pytest
from needs import needs_dds
from polling import wait_until
from programs import Start
from repeating import repeated

from generated.messages import BasestationControlMode, DrivingBoardMotorMessage
from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.drive.drive_parameters import DriveParameters
from roverlink.drive.drive_rows import MODE, DriveRows
from roverlink.drive.driving import Driving
from roverlink.ros_connection import RosConnection
from roverlink.runtime import Qos
from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces import Time
from roverlink.runtime.interfaces.geometry_msgs import Point, Pose, PoseStamped, Twist, TwistStamped, Vector3
from roverlink.runtime.interfaces.nav_msgs import Odometry, Path
from roverlink.runtime.interfaces.rosgraph_msgs import Clock
from roverlink.runtime.interfaces.std_msgs import Header, String
from roverlink.runtime.middleware import NodeIdentity, open_middleware
from roverlink.runtime.ros_arguments import ros_args
from roverlink.runtime.ros_time.headers import header_of

_LATCHED = Qos(depth=1, durability="transient_local")
_S = 10**9
_BEGAN = 100 * _S
_PERIOD = _S // 20


def _twist(linear: float, angular: float = 0.0) -> Twist:
    return Twist(Vector3(linear), Vector3(0, 0, angular))


def _path(*points: tuple[float, float], frame: str = "map", stamp: int = 0) -> Path:
    return Path(header_of(stamp, frame), [PoseStamped(pose=Pose(Point(x, y))) for x, y in points])


# --- the program, with a bridge, a board and a basestation --------------------------------------------------------


@needs_dds
def test_velocities_reach_the_board_while_the_basestation_says_so(
    start: Start, environment: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Twist, then TwistStamped of another program. When a person takes over, there is one stop and then silence."""
    for name in ("ROS_DOMAIN_ID", "ROS_LOCALHOST_ONLY"):
        monkeypatch.setenv(name, environment[name])
    with ExitStack() as held:
        board = held.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        board.bind(("127.0.0.1", 0))
        board.settimeout(0.2)
        basestation = held.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
        ros = ("listen_port:=0", "listen_address:='127.0.0.1'", f"dst_b_port:={board.getsockname()[1]}")
        bridge = start("run", "--middleware", "dds", "--ros-args", *(word for one in ros for word in ("-p", one)))
        given = ("-p", "mode_timeout:=60.0", "-p", "timeout:=2.0")  # long enough for a busy machine
        program = start("drive", "--middleware", "dds", "--json", "--ros-args", *given)
        address = "127.0.0.1", int(bridge.wait_for("on UDP port ").rpartition(" ")[2])
        program.wait_for("while /control_mode is AUTO")

        def tell(mode: int) -> None:
            basestation.sendto(REGISTRY.envelope(control_mode={"mode": mode}).SerializeToString(), address)

        def command() -> Any:
            try:
                envelope = REGISTRY.envelope.FromString(board.recv(2000))
            except TimeoutError:
                return None
            return envelope.drive_motor if envelope.WhichOneof("payload") == "drive_motor" else None

        mode = 1
        held.enter_context(repeated(lambda _: tell(mode), 0.1))
        with open_middleware("dds", NodeIdentity("controller")) as node:
            velocities = node.publisher("/cmd_vel", Twist, Qos())
            with repeated(lambda _: velocities.publish([cdr.encode(_twist(0.3, 0.15))])):
                straight = wait_until(lambda: (one := command()) and one.distance_to_go > 0.1 and one, "a command")
        assert straight.turning_radius == pytest.approx(2.0)
        assert straight.distance_to_go <= 0.3 * 0.4 + 1e-6
        program.wait_for("idle: no velocity for 2 s")
        node = held.enter_context(open_middleware("dds", NodeIdentity("other_controller")))
        states: list[str] = []
        node.subscribe("/drive/state", String, _LATCHED, lambda data: states.extend(_texts(data)))
        wait_until(lambda: states == ["idle: no velocity for 2 s"], "the state, which was published before")
        stamped = node.publisher("/cmd_vel", TwistStamped, Qos())

        published: list[int] = []

        def publish(number: int) -> None:
            header = header_of(time.time_ns(), "base_link")
            stamped.publish([cdr.encode(TwistStamped(header, _twist(0.3, -0.15)))])
            published.append(number)

        with repeated(publish):
            right = wait_until(lambda: (one := command()) and one.turning_radius < 0 and one, "a command")
            assert right.turning_radius == pytest.approx(-2.0)
            mode = 0
            program.wait_for("manual: control_mode is MANUAL")
            wait_until(lambda: (one := command()) and one.distance_to_go == 0, "the stop")
            more = len(published) + 20
            wait_until(lambda: len(published) > more, "more velocities")
            wait_until(lambda: states[-1] == "manual: control_mode is MANUAL", "the state")
        assert program.interrupt() == 0
    entries = [json.loads(line) for line in program.output]
    distances = [one["distance_to_go"] for one in entries if "distance_to_go" in one]
    assert [one["reason"] for one in entries[-2:]] == ["control_mode is MANUAL", "this program ends"]
    assert entries[-3]["distance_to_go"] == 0
    assert distances[-2] > 0


def _texts(messages: Sequence[bytes]) -> list[str]:
    return [cdr.decode(String, data).data for data in messages]


# --- in memory, in the time of a simulation -----------------------------------------------------------------------


class _Drive:
    """The node in memory, without its command line; the time passes only here."""

    def __init__(self, held: ExitStack, *parameters: str) -> None:
        words = [word for one in ("use_sim_time:=true", *parameters) for word in ("-p", one)]
        ros = ros_args.parse(words, "drive")
        self.log: list[str] = []
        logger = logging.Logger("test")
        logger.addHandler(handler := logging.Handler())
        handler.emit = lambda record: self.log.append(record.getMessage())  # type: ignore[method-assign]
        self.parameters = DriveParameters(ros, logger)
        connection = RosConnection(ros, "memory", held, logger.warning, self.parameters)
        self.node, self._now = connection.middleware, _BEGAN
        self._publishers: dict[str, Any] = {}
        with repeated(lambda _: self.publish("/clock", Clock(Time.since_1970(_BEGAN)))):
            assert connection.clock.now() == _BEGAN
        self.driving = Driving(connection, DriveRows(REGISTRY), self.parameters, logger, as_json=False)
        self.sent: list[DrivingBoardMotorMessage] = []
        self.states: list[str] = []
        self.node.subscribe(
            "/drive_motor",
            DrivingBoardMotorMessage,
            Qos(),
            lambda messages: self.sent.extend(cdr.decode(DrivingBoardMotorMessage, data) for data in messages),
        )
        self.node.subscribe("/drive/state", String, Qos(), lambda messages: self.states.extend(_texts(messages)))
        self.driving.receive()

    @property
    def now(self) -> int:
        """The time in nanoseconds."""
        return self._now

    def log_about(self, text: str) -> list[str]:
        """The lines of the log with a text, without the states."""
        return [one for one in self.log if text in one and one not in self.states]

    def publish(self, topic: str, message: Message) -> None:
        """Publish a message."""
        if topic not in self._publishers:
            self._publishers[topic] = self.node.publisher(topic, type(message), Qos())
        self._publishers[topic].publish([cdr.encode(message)])

    def tick(self, count: int = 1, automatic: bool = True) -> None:
        """Let time pass, in which the basestation repeats the mode."""
        for _ in range(count):
            self._now += _PERIOD
            self.publish("/clock", Clock(Time.since_1970(self._now)))
            if automatic:
                self.publish("/control_mode", BasestationControlMode(1))
            self.driving.tick()

    def drive(self, message: Message, count: int = 1) -> None:
        """Publish a velocity again and again."""
        for _ in range(count):
            if isinstance(message, TwistStamped) and message.header.stamp.sec:
                message = replace(message, header=header_of(self._now, message.header.frame_id))
            self.publish("/cmd_vel", message)
            self.tick()

    def localize(self, x: float = 0.0, frame: str = "map", child: str = "base_link", late: float = 0.0) -> Odometry:
        """Return the pose of the rover."""
        message = Odometry(header_of(self._now - round(late * _S), frame), child)
        message.pose.pose.position.x = x
        return message


@pytest.fixture
def drive() -> Iterator[_Drive]:
    """The node, which sends a command at each tick."""
    with ExitStack() as held:
        yield _Drive(held, "rate:=20.0")


def test_a_path_is_followed_in_simulated_time(drive: _Drive) -> None:
    """To its end, with the poses of the localization; the states tell each step."""
    drive.tick(2)
    drive.publish("/path", _path((0, 0), (1, 0), stamp=drive.now))
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
    drive.publish("/clock", Clock(Time.since_1970(_S)))
    drive.driving.tick()
    assert drive.sent[-1] == DrivingBoardMotorMessage()
    assert drive.states[-1] == "manual: the time has jumped back; waiting for control_mode"


def test_the_basestation_must_repeat_the_mode(drive: _Drive) -> None:
    """A link that is cut stops the rover within the time of the parameter, although velocities go on."""
    drive.drive(_twist(0.3), 4)
    for _ in range(30):
        drive.publish("/cmd_vel", _twist(0.3))
        drive.tick(automatic=False)
    assert drive.states[-1] == "manual: no control_mode for 1.1 s; is the basestation's link cut?"
    moving = [one for one in drive.sent if one.distance_to_go]
    assert drive.sent[-1] == DrivingBoardMotorMessage()
    assert len(drive.sent) == len(moving) + 1


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
            stamp = drive.now + round(seconds * _S)
            drive.publish("/cmd_vel", replace(_STAMPED, header=header_of(stamp, "base_link")))
            drive.tick()
        expected = f"ignoring a velocity: its stamp is {reason}; is the clock of its computer right?"
        assert drive.log.count(expected) == 1
        assert drive.states[-1] == "idle: no velocity for 0.5 s"
    drive.drive(TwistStamped(twist=_twist(0.3)), 2)
    assert drive.states[-1] == "driving"


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"stamp": _BEGAN - 11 * _S}, "ignoring a path: its stamp is more than 10 s old; is the clock of its"),
        ({"frame": "odom"}, "the path is refused: the path is in the frame 'odom', but the pose is in 'map'"),
    ],
)
def test_paths_that_cannot_be_used_are_told(drive: _Drive, changes: dict[str, Any], expected: str) -> None:
    """The rover does not move."""
    drive.tick()
    drive.publish("/path", _path((0, 0), (5, 0), **changes))
    drive.publish("/odometry/global", drive.localize())
    drive.tick(2)
    assert drive.log_about(expected)
    assert drive.sent == []


def test_a_path_in_two_frames_is_ignored(drive: _Drive) -> None:
    """The message names them."""
    drive.tick()
    path = _path((0, 0), (5, 0))
    path.poses[1].header.frame_id = "odom"
    drive.publish("/path", path)
    assert "ignoring a path: it is in the frame 'map', but has poses in ['odom']" in drive.log


def _uncertain(message: Odometry) -> Odometry:
    # x and y are correlated: 0.6 m in one direction, 0.1 m in the other
    xx, xy = (0.6**2 + 0.1**2) / 2, (0.6**2 - 0.1**2) / 2
    message.pose.covariance[0:2] = message.pose.covariance[7:5:-1] = [xx, xy]
    return message


@pytest.mark.parametrize(
    ("change", "log", "state"),
    [
        ({"late": 0.6}, "", "waiting: the newest pose is more than 0.5 s old"),
        (
            {"child": "camera_link"},
            "it is the pose of 'camera_link', not of 'base_link'",
            "waiting: no pose has come yet",
        ),
        ({"late": -0.6}, "its stamp is in the future; is the clock of its", "waiting: no pose has come yet"),
        ({"late": 100.0}, "it has no stamp", "waiting: no pose has come yet"),
        ({"x": math.nan}, "it has a value that is not a number", "waiting: no pose has come yet"),
        ({"uncertain": True}, "", "waiting: the position is uncertain by more than 0.5 m"),
    ],
)
def test_the_rover_waits_for_a_pose_that_it_can_use(
    drive: _Drive, change: dict[str, Any], log: str, state: str
) -> None:
    """The reason is in the state, and that of ignored messages in the log; a usable pose lets the rover go on."""
    uncertain = change.pop("uncertain", False)
    drive.tick()
    drive.publish("/path", _path((0, 0), (5, 0)))
    for _ in range(5):
        place = drive.localize(**change)
        if change.get("late") == 100.0:
            place.header.stamp = Time()
        drive.publish("/odometry/global", _uncertain(place) if uncertain else place)
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
        drive.node.publisher(topic, String, Qos()).publish([b"\0\1\0\0"])
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
    drive.driving.end()
    assert drive.sent[-1] == DrivingBoardMotorMessage()
    assert drive.states[-1] == "manual: this program ends"
    count = len(drive.sent)
    drive.drive(_twist(0.3), 3)
    assert len(drive.sent) == count


# --- the contract -------------------------------------------------------------------------------------------------


def test_a_table_without_the_rows_is_refused() -> None:
    """The message names the row, or what it lacks."""
    others = tuple(handler for handler in REGISTRY.handlers if handler.route.name != MODE)
    with pytest.raises(SetupError, match="the table has no row 'control_mode' in the direction from a peer"):
        DriveRows(replace(REGISTRY, handlers=others))

    class Handler(type(REGISTRY.by_name[MODE])):  # type: ignore[misc]  # a class of the registry's
        message_type = DrivingBoardMotorMessage

    with pytest.raises(SetupError, match="has no field mode; add it"):
        DriveRows(replace(REGISTRY, handlers=(REGISTRY.by_name["drive_motor"], Handler())))


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("-p", "speed:=fast"), "the parameter 'speed' is 'fast'; it must be a number"),
        (("-p", "rate:=4.0"), "the parameter 'horizon' is 0.4 s; it must be at least 2 / rate = 0.5 s"),
        (("-p", "sped:=1.0"), "unknown parameter 'sped'; "),
    ],
)
def test_mistakes_are_one_line(words: tuple[str, ...], expected: str, capsys: pytest.CaptureFixture[str]) -> None:
    """The exit code is 2."""
    assert main(["drive", "--middleware", "memory", "--ros-args", *words]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert expected in line


def test_a_folder_without_a_project_is_refused(tmp_path: FilePath, capsys: pytest.CaptureFixture[str]) -> None:
    """The exit code is 2."""
    assert main(["drive", "--middleware", "memory", "--project", str(tmp_path)]) == 2
    assert "generated" in capsys.readouterr().err
