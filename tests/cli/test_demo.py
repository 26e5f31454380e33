"""`roverlink demo`, and the parts of which it is made."""

from __future__ import annotations

import importlib.util
import io
import math
import os
import re
import sys
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from needs import NO_AV, NO_OPENCV, needs_dds
from rich.console import Console

from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.console import isolate_ros
from roverlink.demo.demo_rover import DemoRover
from roverlink.demo.shuttle import START, Shuttle
from roverlink.driving.arcs import PlanarPose
from roverlink.driving.rover_model import RoverModel
from roverlink.generator.example_payloads import payload_at
from roverlink.runtime import SetupError
from roverlink.runtime.client import Received
from roverlink.simulation import crossings
from roverlink.simulation.bridge_host import BridgeProcess
from roverlink.simulation.crossings import Crossing

Start = Callable[..., Any]


@pytest.fixture(autouse=True)
def _own_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the demo does to the environment ends with the test."""
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")


@pytest.mark.slow
@pytest.mark.parametrize("middleware", ["memory", pytest.param("dds", marks=needs_dds)])
def test_every_message_crosses(done: Start, middleware: str) -> None:
    """In three seconds all messages cross, it ends by itself with exit code 0, and says what the bridge counted."""
    code, output, errors = done("demo", "--seconds", 3, "--middleware", middleware)
    assert code == 0, output
    # where the processor is shared with many, commands come late, which the bridge has to say
    assert [line for line in errors.splitlines() if "the topic is silent" not in line] == []

    def numbers(pattern: str) -> list[float]:
        found = re.search(pattern, output)
        assert found, f"{pattern}\n{output}"
        return [*map(float, found.groups())]

    crossed, forwarded = numbers(r"21 of 21 messages were bridged, (\d+) times in all; (\d+) datagrams were forwarded")
    assert crossed >= 21
    assert forwarded >= 12
    received, published = numbers(r"counters of the bridge: received (\d+), published (\d+), sent \d+, forwarded \d+")
    assert received == published > 0
    assert "not bridged" not in output
    driven, off = numbers(r"the rover drove ([\d.]+) m .*; its wheel odometry is (\d+) mm beside the truth")
    assert driven > 0
    assert off < 500  # a busy machine is late with some reports
    if importlib.util.find_spec("cv2"):
        frames, error = numbers(r"located the rover in (\d+) frames with 4 landmarks; largest error (\d+) mm")
        assert frames > 0
        assert error <= 30
    else:
        assert "pip install 'opencv-contrib-python-headless>=4.8'" in output
    for handler in REGISTRY.handlers:
        assert re.search(rf"{handler.route.number} . {handler.route.name} ", output)


@pytest.mark.slow
@pytest.mark.skipif(not importlib.util.find_spec("av"), reason=NO_AV)
def test_the_page_shows_the_video_of_the_camera_and_the_paths_of_the_rover(start: Start) -> None:
    """The video as it arrives; the true path and both estimated ones, landmarks; the end of the demo is told."""
    from tests.vision.browsing import visiting  # it needs OpenCV

    demo = start("demo", "--seconds", 120, "--middleware", "memory")
    told = "page with the video of the camera and the paths of the rover: http"
    url = demo.wait_for(told, demo.output).rpartition(": ")[2]
    with visiting() as visitor:
        visitor.open(url)
        camera = 'section[aria-label="camera"]'
        visitor.until(lambda: visitor.count(camera) and "images/s" in visitor.text(camera))
        visitor.until(lambda: visitor.run(f"return document.querySelector('{camera} img').naturalWidth") == 640)
        visitor.until(lambda: "wheel odometry" in visitor.text("#map-note"))
        for path in ("true", "estimated", "odometry"):  # 2.2 m along x
            box = f"return document.querySelector('#map .{path}').getBBox()"
            visitor.until(lambda box=box: 1.5 < visitor.run(box)["width"] < 3)
            assert visitor.run(box)["height"] < 1
        assert visitor.count("#map .landmark") == 4
        assert visitor.complaints() == []
        demo.interrupt()
        visitor.until(lambda: "NO CONNECTION" in visitor.text("#connection"))


@pytest.mark.slow
def test_an_interrupted_demo_is_exit_code_130(start: Start) -> None:
    """A script does not take it for a demo that has shown all messages."""
    demo = start("demo", "--seconds", 60, "--middleware", "memory")
    demo.wait_for("messages were bridged", demo.output)
    assert demo.interrupt() == 130


@pytest.mark.slow
def test_messages_that_do_not_cross_are_exit_code_1(capsys: pytest.CaptureFixture[str]) -> None:
    """Without any time nothing crosses: each message is named, and the exit code is 1."""
    assert main(["demo", "--seconds", "0", "--middleware", "memory"]) == 1
    output = capsys.readouterr().out
    assert "0 of 21 messages were bridged" in output
    missing = output.partition("not bridged: ")[2].replace("\n", " ")
    assert [name.strip() for name in missing.split(",")] == [handler.route.name for handler in REGISTRY.handlers]


class _NoBoards:
    """Boards whose datagrams go nowhere."""

    def send_datagram(self, datagram: bytes) -> None:
        """Forget it."""


def test_the_rover_moves_by_messages_on_drive_motor_alone() -> None:
    """It stands without one, and drives the distance of one; other payloads do not matter."""
    rover, command = DemoRover(REGISTRY), REGISTRY.by_name["drive_motor"]

    def drive(payload: Received | None) -> float:
        before = rover.pose
        if payload:
            rover.receive(payload)
        for _ in range(300):
            rover.step(_NoBoards())  # type: ignore[arg-type]
        return rover.pose.distance_to(before)

    assert drive(None) == 0
    other = REGISTRY.by_name["arm_target"]
    assert drive(Received(other.route.number, payload_at(other.payload_type, 1.0))) == 0
    payload = command.payload_type(distance_to_go=0.5)
    assert drive(Received(command.route.number, payload)) == pytest.approx(0.5, abs=0.15)  # with slip
    assert "the rover drove 0.5 m" in rover.stop()


@pytest.mark.slow
def test_slip_does_not_carry_the_rover_away() -> None:
    """For a minute, which is 24 m, it drives to and fro within its limits, and looks to the landmarks."""
    rover, driver = RoverModel(0, start=START), Shuttle()
    for _ in range(600):
        rover.command(driver.command(rover.pose))
        rover.advance(0.1)
        assert abs(rover.pose.yaw) < math.radians(28)  # half of what the camera sees
        assert abs(rover.pose.y) < 0.4
        assert -1.4 < rover.pose.x < 1.2
    assert rover.rolled > 20


def test_images_belong_to_poses_also_after_a_lost_connection() -> None:
    """A program that connects again goes on counting from the images that it got."""
    pytest.importorskip("cv2", reason=NO_OPENCV)
    from roverlink.demo.rover_images import SentImages

    sent = SentImages()
    sent.connect().extend(map(PlanarPose, range(3)))
    assert [sent.pose(number, time.time_ns()).x for number in (0, 1)] == [0, 1]  # the last image was lost
    sent.connect().extend(map(PlanarPose, range(3, 9)))
    assert [sent.pose(number, time.time_ns()).x for number in (2, 4)] == [3, 5]


def test_a_rate_is_that_of_the_last_two_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Messages count for two seconds; the count is for good."""
    now = 100.0
    monkeypatch.setattr(time, "monotonic", lambda: now)
    crossing = Crossing(REGISTRY.handlers[0])
    assert crossing.rate() == 0
    for _ in range(10):
        crossing.add(dict)
        now += 0.1
    assert crossing.rate() == 5.0
    now += 1.5
    assert crossing.rate() == 2.5
    now += 10
    assert crossing.rate() == 0
    assert crossing.count == 10


def test_the_table_shows_each_message_with_its_last_value() -> None:
    """Number, name, direction, rate, count, and the last message in brief."""
    crossing = Crossing(REGISTRY.by_name["imu_info"])
    crossing.add(lambda: {"accel_x": 1.23456})
    console = Console(width=120, record=True, file=io.StringIO())
    console.print(crossings.table([crossing, Crossing(REGISTRY.by_name["drive_motor"])], "title"))
    lines = [re.sub(r"\s*│\s*", "|", line) for line in console.export_text().splitlines()]
    assert any("title" in line for line in lines)
    assert "|13|imu_info|hardware→ros|0.5/s|1|accel_x 1.23|" in lines
    assert "|9|drive_motor|ros→hardware|0.0/s|0||" in lines


def test_a_message_in_brief() -> None:
    """The first fields on one line, numbers short, nested messages and lists hinted at."""
    assert crossings.brief({"a": 1, "b": True, "c": "x"}) == "a 1, b True, c x"
    nested = {"x": 1.0, "y": 0.12345, "z": 3}
    assert crossings.brief({"a": nested, "b": [1, 2, 3], "c": 3, "d": 4, "e": 5}) == "a {1, 0.123…}, b [3], c 3, d 4, …"


@pytest.mark.slow
def test_a_bridge_that_does_not_start_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Where the bridge's process ends before it is ready, its own words are shown, and the demo cannot run."""
    with pytest.raises(SetupError, match="the bridge process did not start"), BridgeProcess(tmp_path, "dds", {}):
        pass
    assert f"no generated code in {tmp_path}" in capsys.readouterr().err


def test_a_bridge_that_does_not_end_well_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A bridge that fails when it is stopped is an error of the demo's, not a traceback."""
    script = tmp_path / "python"
    script.write_text(
        f"#!{sys.executable}\nimport signal, sys, time\nsignal.signal(signal.SIGINT, lambda *_: sys.exit(3))\n"
        "print('{\"port\": 1}', flush=True)\nwhile True:\n    time.sleep(1)\n"
    )
    script.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(script))
    expected = "the bridge ended with exit code 3"
    with BridgeProcess(Path.cwd(), "dds", {}) as process, pytest.raises(SetupError, match=expected):
        process.stop()


def test_the_demo_keeps_to_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """It stays on this host, as each distribution calls that, and in a domain of its own unless one was chosen."""
    monkeypatch.setenv("ROS_LOCALHOST_ONLY", "0")
    monkeypatch.delenv("ROS_DOMAIN_ID", raising=False)
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
    monkeypatch.setenv("ROS_DISTRO", "jazzy")
    with ExitStack() as held:
        isolate_ros(held)
        assert os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] == "LOCALHOST"
        assert os.environ["ROS_LOCALHOST_ONLY"] == "0"
        monkeypatch.setenv("ROS_DISTRO", "humble")
        isolate_ros(held)
        assert os.environ["ROS_LOCALHOST_ONLY"] == "1"
        assert 0 < int(os.environ["ROS_DOMAIN_ID"]) <= 100
    assert "ROS_DOMAIN_ID" not in os.environ
    monkeypatch.setenv("ROS_DOMAIN_ID", "7")
    with ExitStack() as held:
        isolate_ros(held)
    assert os.environ["ROS_DOMAIN_ID"] == "7"
