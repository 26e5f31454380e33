"""``roverlink simulate-rover``: datagrams that a seed repeats, in the units of the table, and the true pose."""

from __future__ import annotations

import json
import math
import random
import socket
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from needs import NO_OPENCV
from polling import wait_until
from programs import Start
from roverkit.driving.board_commands import BoardCommand
from roverkit.simulation.rover_datagrams import RoverDatagrams
from roverkit.simulation.rover_model import MotorReport, ProgressReport, RoverModel
from roverkit.simulation.rover_sensors import GpsFix, ImuReading
from roverkit.simulation.simulated_rover import Pace, RoverSimulation, Scenario

from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.runtime import Translator
from roverlink.runtime.client import Received
from roverlink.runtime.core.errors import SetupError
from roverlink.simulation.scenarios import SCENARIOS, World

_TURN = BoardCommand(20.0, 2.0)


class _Boards:
    """A bridge that has sent one command, and that keeps what comes."""

    def __init__(self, command: BoardCommand = _TURN) -> None:
        self.datagrams: list[bytes] = []
        row = REGISTRY.by_name["drive_motor"]
        payload = row.payload_type(distance_to_go=command.distance_to_go, turning_radius=command.turning_radius)
        self._waiting = [Received(row.route.number, payload)]

    def arrived(self) -> Sequence[Received]:
        """The command, once."""
        arrived, self._waiting = self._waiting, []
        return arrived

    def send_datagram(self, datagram: bytes) -> None:
        """Keep it."""
        self.datagrams.append(datagram)


def _simulated(seed: int, seconds: float, *names: str, restarts: bool = False) -> tuple[list[bytes], RoverModel]:
    """The datagrams of a rover, and the rover at the end."""
    rover, boards = RoverModel(seed), _Boards()
    simulation = RoverSimulation(rover, RoverDatagrams(REGISTRY), boards, Pace(math.inf, pytest.fail))
    world = World(REGISTRY, random.Random(seed), 1472)  # noqa: S311  # repeatable, not secret
    changes: list[Scenario] = [lambda stream, one=SCENARIOS[name]: one(stream, world) for name in names]  # type: ignore[misc]
    generator = random.Random(seed) if restarts else None  # noqa: S311  # as above
    simulation.run(changes, seconds, generator)
    assert simulation.sent.total() == len(boards.datagrams)
    return boards.datagrams, rover


def _payloads(datagrams: Sequence[bytes]) -> dict[str, list[Any]]:
    found = defaultdict(list)
    for datagram in datagrams:
        envelope = REGISTRY.envelope.FromString(datagram)
        name = envelope.WhichOneof("payload")
        found[name].append(getattr(envelope, name))
    return found


@pytest.mark.parametrize("names", [(), ("lossy", "stale", "padded", "malformed")])
def test_a_seed_repeats_the_datagrams(names: tuple[str, ...]) -> None:
    """The bytes are the same, also with faults; another seed gives other ones."""
    datagrams, _ = _simulated(3, 2, *names)
    assert datagrams == _simulated(3, 2, *names)[0]
    assert datagrams != _simulated(4, 2, *names)[0]


def test_the_rover_drives_the_command_that_it_receives() -> None:
    """Its boards report this at their rates, and the bridge accepts each datagram."""
    datagrams, rover = _simulated(1, 10)
    assert rover.rolled == pytest.approx(0.5 * 10, abs=0.3)
    assert rover.pose.yaw == pytest.approx(2.4, abs=0.3)
    payloads = _payloads(datagrams)
    counts = {name: len(values) for name, values in payloads.items()}
    assert counts == {"drive_progress": 200, "drive_diag": 100, "imu_info": 500, "gps_info": 50}
    assert payloads["drive_progress"][-1].distance_left == pytest.approx(20 - rover.rolled, abs=1e-3)
    translator = Translator(REGISTRY)
    for datagram in datagrams[:100]:
        translator.receive(datagram)


def test_the_units_are_those_of_the_table() -> None:
    """deg/s, m/s^2 and uT for the IMU, degrees for the GPS, rpm for the motors."""
    model = RoverModel(1)
    model.command(_TURN)
    measured = model.advance(10)
    payloads = _payloads(_simulated(1, 10)[0])

    def last(kind: type[Any]) -> Any:
        return [one for one in measured if isinstance(one, kind)][-1]

    imu, said = last(ImuReading), payloads["imu_info"][-1]
    assert said.gyro_z == pytest.approx(math.degrees(imu.angular_velocity[2]), rel=1e-5)
    assert said.accel_z == pytest.approx(imu.linear_acceleration[2], rel=1e-5)
    assert said.mag_z == pytest.approx(1e6 * imu.magnetic_field[2], rel=1e-5)
    assert (said.is_calibrated, said.error_code) == (True, 0)
    fix, said = last(GpsFix), payloads["gps_info"][-1]
    assert (said.latitude, said.longitude, said.fix_quality) == (fix.latitude, fix.longitude, 1)
    motors, said = last(MotorReport), payloads["drive_diag"][-1]
    assert said.state == 1
    assert said.front_left_motor.rpm == pytest.approx(motors.left_rpm, rel=1e-5)
    assert said.back_right_motor.rpm == pytest.approx(motors.right_rpm, rel=1e-5)
    assert said.steering_front_left_motor.encoder_angle == pytest.approx(math.degrees(motors.steering), rel=1e-5)
    assert said.steering_back_left_motor.encoder_angle == pytest.approx(-math.degrees(motors.steering), rel=1e-5)
    assert len({motor.motor_id for _, motor in said.ListFields() if hasattr(motor, "motor_id")}) == 10
    assert last(ProgressReport).distance_left == pytest.approx(payloads["drive_progress"][-1].distance_left, abs=1e-5)


def test_a_board_that_restarts_forgets_its_command() -> None:
    """It is silent for a second, and then reports that nothing is left."""
    datagrams, rover = _simulated(1, 30, restarts=True)
    progress = _payloads(datagrams)["drive_progress"]
    assert rover.rolled < 12
    assert progress[-1].distance_left == 0
    assert len(progress) < 600 - 15


def test_a_command_that_is_no_number_is_ignored() -> None:
    """As a real board does; a network that refuses datagrams is counted, and the simulation goes on."""

    class Refusing(_Boards):
        def send_datagram(self, datagram: bytes) -> None:
            raise OSError

    rover = RoverModel(1)
    boards = Refusing(BoardCommand(math.nan, 0.0))
    simulation = RoverSimulation(rover, RoverDatagrams(REGISTRY), boards, Pace(math.inf, pytest.fail))
    simulation.run([], 1)
    assert rover.rolled == 0
    assert (simulation.unsendable, simulation.sent.total()) == (85, 0)


@pytest.mark.slow
def test_the_program_is_a_peer_of_the_bridge(start: Start, peer: socket.socket) -> None:
    """Over UDP: it gets a command, and its reports come back; at the end it says where the rover is."""
    options = ("--to", f"127.0.0.1:{peer.getsockname()[1]}", "--listen", 0, "--middleware", "none", "--json")
    rover = start("simulate-rover", *options, "--speed", 4)
    port = int(rover.wait_for("its boards listen on UDP port ").rpartition(" ")[2])
    command = REGISTRY.envelope(drive_motor={"distance_to_go": 5.0}).SerializeToString()
    peer.sendto(command, ("127.0.0.1", port))  # once, because each command begins a new arc

    def drives() -> bool:
        left = REGISTRY.envelope.FromString(peer.recv(2000)).drive_progress.distance_left
        return 0 < left < 4.9

    wait_until(drives, "the progress")
    assert rover.interrupt() == 0
    (line,) = rover.output
    report = json.loads(line)
    assert report["rolled"] > 0
    assert report["pose"]["x"] > 0
    assert report["sent"]["drive_progress"] > 0


@pytest.mark.slow
def test_it_simulates_for_some_seconds(capsys: pytest.CaptureFixture[str]) -> None:
    """Of the rover's time, as fast as possible."""
    options = ("--middleware", "none", "--speed", "max", "--seconds", "60", "--listen", "0", "--to", "127.0.0.1:9")
    assert main(["simulate-rover", *options]) == 0
    first, second = capsys.readouterr().out.splitlines()
    assert first.startswith("simulated 60.0 s; sent 600 drive_diag, 1200 drive_progress, 300 gps_info, 3000 imu_info;")
    assert second == "the wheels rolled 0.00 m; the rover is at x 0.00 m, y 0.00 m, yaw 0.0 deg"


@pytest.mark.slow
def test_the_tracker_finds_the_camera_in_the_images(tmp_path: Path) -> None:
    """Where the rover is, from the images alone; markers behind it, or beside the image, are not seen."""
    pytest.importorskip("cv2", reason=NO_OPENCV)
    from roverkit.demo.field import SIDE, parameters
    from roverkit.driving.arcs import PlanarPose
    from roverkit.simulation.rover_camera import FRAME, RoverCamera
    from roverkit.vision import MarkerSet, Tracker, localize, read_landmarks
    from roverkit.vision.ros.camera_info import camera_of

    file = tmp_path / "landmarks.yaml"
    places = {7: "3.0, 0.9, 0.9", 8: "3.4, 0.2, 0.6", 9: "2.6, -0.5, 0.5", 11: "-3.0, 0.0, 0.5"}
    yaws = {7: -90, 8: -90, 9: -90, 11: 90}  # the last one is behind the rover
    rows = [f"{one}: {{position: [{places[one]}], rpy: [90, 0, {yaws[one]}]}}" for one in places]
    file.write_text(f"landmarks: {{{', '.join(rows)}}}")
    camera, known = RoverCamera(file, 1), read_landmarks(file)
    image, info = camera.messages(PlanarPose(0.5, 0.1, 0.2), 5 * 10**9)
    assert (image.header.frame_id, info.header, image.encoding) == (FRAME, image.header, "mono8")
    assert camera_of(info, rectified=False).matrix.tolist() == parameters().matrix.tolist()
    tracker = Tracker(parameters(), MarkerSet(side=SIDE))
    for rover, visible in ((PlanarPose(0.5, 0.1, 0.2), {7, 8}), (PlanarPose(-1.0, -0.5, 0.1), {7, 8, 9})):
        detections = tracker.track(camera.image(rover), 0)
        assert {one.id for one in detections} == visible
        place = localize(detections, known)
        assert place is not None
        x, y, z = place.pose.translation
        assert math.hypot(x - rover.x, y - rover.y) < 0.03
        assert z == pytest.approx(0.6, abs=0.03)


@pytest.mark.parametrize(
    ("name", "expected"),
    [("gate", "'gate' is a board; the simulated rover sees"), ("999", "the dictionary DICT_5X5_250 has no marker 999")],
)
def test_landmarks_that_cannot_be_rendered_are_refused(name: str, expected: str, tmp_path: Path) -> None:
    """The message names the file and the landmark."""
    pytest.importorskip("cv2", reason=NO_OPENCV)
    from roverkit.simulation.rover_camera import RoverCamera

    (tmp_path / "landmarks.yaml").write_text(f"landmarks: {{{name}: {{position: [1, 0, 1], rpy: [90, 0, -90]}}}}")
    with pytest.raises(SetupError, match=expected):
        RoverCamera(tmp_path / "landmarks.yaml", 1)
