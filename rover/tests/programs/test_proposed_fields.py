"""The fields that rover/docs/driving.md proposes: with the edits of the page, the programs use them."""

from __future__ import annotations

import re
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from node_in_memory import SECOND, NodeInMemory
from roverkit.driving.drive_node import Driving
from roverkit.driving.drive_parameters import DriveParameters
from roverkit.driving.drive_rows import DriveRows
from roverkit.odometry.odometry_parameters import OdometryParameters
from roverkit.odometry.odometry_rows import OdometryRows
from roverkit.odometry.wheel_odometry_node import OdometryNode
from roverkit.simulation.rover_datagrams import RoverDatagrams
from roverkit.simulation.rover_model import RoverModel

from roverlink.generator.pipeline import compile_table
from roverlink.runtime import Registry, load_registry
from roverlink.runtime.interfaces.geometry_msgs import Twist, Vector3
from roverlink.runtime.interfaces.nav_msgs import Odometry

pytestmark = pytest.mark.slow
_ROOT = Path(__file__).parents[3]
_SECTION = "\n## Add an odometer and a number to the reports\n"
_EDIT = re.compile(r"^--- (?P<path>\S+)\n.*\n@@\n(?P<hunk>(?:[ +].*\n)+)", re.MULTILINE)


@pytest.fixture(scope="module")
def registry(tmp_path_factory: pytest.TempPathFactory) -> Registry:
    """The sample's project after the edits of the page."""
    files = {str(path.relative_to(_ROOT)): path.read_text() for path in (_ROOT / "proto").rglob("*.proto")}
    page = (_ROOT / "rover" / "docs" / "driving.md").read_text()
    for path, hunk in _EDIT.findall(page.partition(_SECTION)[2]):
        lines = hunk.splitlines(keepends=True)
        before = "".join(line[1:] for line in lines if line.startswith(" "))
        assert before in files[path]
        files[path] = files[path].replace(before, "".join(line[1:] for line in lines))
    folder = tmp_path_factory.mktemp("numbered")
    table = re.sub(r"(proto|message): (?=\w+$)", r"\1: numbered.", (_ROOT / "mapping.yaml").read_text(), flags=re.M)
    table = table.replace("components/", "numbered/components/").replace(
        "  SensorState: {", "  numbered.SensorState: {"
    )
    _write(folder, {_numbered(path): _numbered(text) for path, text in files.items()})
    _write(folder, {"mapping.yaml": f"{table}\npython: {{package: numbered_rover}}\n"})
    _write(folder, compile_table(folder / "mapping.yaml").files)
    return load_registry(folder, "numbered_rover")


def _numbered(text: str) -> str:
    """Put the protos into a package of their own, because a process can load each message only once."""
    text = re.sub(r"^(syntax = .*)$", r"\1\npackage numbered;", text, flags=re.MULTILINE)
    return re.sub(r'^(proto/|import ")components', r"\1numbered/components", text, flags=re.MULTILINE)


def _write(folder: Path, files: Any) -> None:
    for path, text in files.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text, encoding="utf-8")


def test_odometry_follows_the_odometer_of_a_simulated_rover(registry: Registry) -> None:
    """The datagrams of the simulation have the fields; four of five reports are lost, and commands are not heard."""
    with ExitStack() as held:
        node = NodeInMemory(held, "odometry", ["use_sim_time:=true"], OdometryParameters)
        rows, datagrams, rover = OdometryRows(registry), RoverDatagrams(registry), RoverModel(1)
        OdometryNode(node.connection, rows, node.parameters, node.logger, as_json=False).receive()
        found = node.hear("/odometry/wheel", Odometry)
        envelope: Any = registry.envelope
        sent = registry.datagram(
            "drive_motor", envelope(drive_motor={"distance_to_go": 2, "command_number": 7}).drive_motor
        )
        command = datagrams.command(registry.by_name["drive_motor"].route.number, envelope.FromString(sent).drive_motor)
        assert command is not None
        for step in range(160):
            if step == 20:
                rover.command(command)
            reports = [datagrams.datagram(one) for one in rover.advance(0.05)]
            node.pass_time(SECOND // 20)
            progress = [data for name, data in reports if name == "drive_progress"]
            if step % 5 == 0:
                payload = envelope.FromString(progress[-1]).drive_progress
                node.publish("/drive_progress", registry.by_name["drive_progress"].to_ros(payload))
                assert payload.command_number == (7 if step >= 20 else 0)
        position = found[-1].pose.pose.position
        assert rover.rolled == pytest.approx(2)
        assert position.x == pytest.approx(2, abs=1e-3)
        assert node.log == ["no angular velocity comes from the IMU; the turn is that of the steering"]


def test_a_lost_stop_is_sent_again_until_the_board_has_taken_it(registry: Registry) -> None:
    """Or until the board has taken the command of a person; each command has its own number."""
    command, report = registry.by_name["drive_motor"].message_type, registry.by_name["drive_progress"].message_type
    mode = registry.by_name["control_mode"].message_type
    with ExitStack() as held:
        node = NodeInMemory(held, "drive", ["use_sim_time:=true"], DriveParameters)
        driving = Driving(node.connection, DriveRows(registry), node.parameters, node.logger, as_json=False)
        sent = node.hear("/drive_motor", command)
        driving.receive()

        def tick(count: int, number: int, automatic: bool = True) -> list[Any]:
            before = len(sent)
            for _ in range(count):
                node.pass_time(SECOND // 20)
                node.publish("/control_mode", mode(int(automatic)))
                node.publish("/drive_progress", report(0.2, 1.0, number))
                driving.tick()
            return sent[before:]

        tick(2, 0)
        for _ in range(6):
            node.publish("/cmd_vel", Twist(Vector3(0.3)))
            tick(1, 0)
        numbers = [one.command_number for one in sent]
        assert len({*numbers}) == len(numbers) >= 2
        stop, *again = tick(20, numbers[-1], automatic=False)
        assert stop.distance_to_go == 0
        assert 8 <= len(again) <= 10
        assert {one.command_number for one in again} == {stop.command_number}
        assert tick(10, stop.command_number, automatic=False) == []
        assert tick(10, 12345, automatic=False) == []
        assert node.log.count("the driving board has not taken the stop; it is sent again") == 1
