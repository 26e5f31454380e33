"""`roverlink demo`, and the parts of which it is made."""

from __future__ import annotations

import importlib.util
import io
import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from needs import NO_AV, needs_dds
from rich.console import Console

from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.console import isolate_ros
from roverlink.generator.example_payloads import payload_at
from roverlink.runtime import SetupError
from roverlink.simulation import bridge_host, crossings
from roverlink.simulation.bridge_host import BridgeProcess, BridgeThread
from roverlink.simulation.crossings import Crossing

Start = Callable[..., Any]


@pytest.fixture
def own_environment(monkeypatch: pytest.MonkeyPatch, environment: dict[str, str]) -> None:
    """What the demo does to the environment ends with the test."""
    for name in ("ROS_DOMAIN_ID", "ROS_LOCALHOST_ONLY"):
        monkeypatch.setenv(name, environment[name])
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")


@pytest.mark.parametrize(
    "middleware",
    [
        pytest.param("memory", marks=pytest.mark.slow),
        pytest.param("dds", marks=[needs_dds, pytest.mark.slow]),
    ],
)
def test_every_message_crosses(done: Start, middleware: str) -> None:
    """In three seconds all messages cross, it ends by itself with exit code 0, and says what the bridge counted."""
    code, output, errors = done("demo", "--seconds", 3, "--middleware", middleware)
    assert code == 0, output
    # where the processor is shared with many, commands come late, which the bridge has to say
    assert [line for line in errors.splitlines() if "the topic is silent" not in line] == []
    summary = re.search(r"21 of 21 messages were bridged, (\d+) times in all; (\d+) datagrams were forwarded", output)
    assert summary
    assert int(summary[1]) >= 21
    assert int(summary[2]) >= 12
    account = re.search(r"counters of the bridge: received (\d+), published (\d+), sent (\d+), forwarded (\d+)", output)
    assert account
    assert int(account[1]) == int(account[2]) > 0
    assert "not bridged" not in output
    seen = re.search(r"located the rover in (\d+) frames with 4 landmarks; largest error (\d+) mm", output)
    if importlib.util.find_spec("cv2"):
        assert seen
        assert int(seen[1]) > 0
        assert int(seen[2]) <= 10
        if importlib.util.find_spec("onnxruntime") and importlib.util.find_spec("scipy"):
            objects = re.search(r"searched (\d+) frames for objects; it found (\d+)% of them", output)
            assert objects
            assert int(objects[1]) > 3
            assert int(objects[2]) >= 70
        else:
            assert "pip install 'onnxruntime>=1.17'" in output
        if importlib.util.find_spec("av"):
            assert re.search(r"the video of the simulated camera arrived with [1-9]\d* images/s, \d+ ms after", output)
        else:
            assert "pip install 'av>=12'" in output
    else:
        assert "pip install 'opencv-contrib-python-headless>=4.8'" in output
    for handler in REGISTRY.handlers:
        assert re.search(rf"{handler.route.number} . {handler.route.name} ", output)


@pytest.mark.slow
@pytest.mark.skipif(not importlib.util.find_spec("av"), reason=NO_AV)
def test_the_page_shows_the_video_of_the_camera_and_the_path_of_the_rover(start: Start) -> None:
    """The video as it arrives, marked as old when the demo has ended; the true path, the estimated one, landmarks."""
    from tests.vision.browsing import visiting  # it needs OpenCV

    demo = start("demo", "--seconds", 60, "--middleware", "memory")
    url = demo.wait_for("page with the video of the camera and the path of the rover: http", demo.output).rpartition(
        ": "
    )[2]
    with visiting() as visitor:
        visitor.open(url)
        camera = 'section[aria-label="camera"]'
        visitor.until(lambda: visitor.count(camera) and "images/s" in visitor.text(camera))
        visitor.until(lambda: visitor.run(f"return document.querySelector('{camera} img').naturalWidth") == 640)
        visitor.until(lambda: "mm beside the truth" in visitor.text("#map-note"))
        assert float(visitor.text("#map-note").split("is ")[1].split(" mm")[0]) <= 10
        for path in ("true", "estimated"):  # of a circle with the radius 0.3 m
            box = (
                f"const box = document.querySelector('#map .{path}').getBBox(); return Math.max(box.width, box.height)"
            )
            visitor.until(lambda box=box: visitor.run(box) > 0.5)
            assert visitor.run(box) < 0.65
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


@pytest.mark.usefixtures("own_environment")
def test_messages_that_do_not_cross_are_exit_code_1(capsys: pytest.CaptureFixture[str]) -> None:
    """Without any time nothing crosses: each message is named, and the exit code is 1."""
    assert main(["demo", "--seconds", "0", "--middleware", "memory"]) == 1
    output = capsys.readouterr().out
    assert "0 of 21 messages were bridged" in output
    missing = output.partition("not bridged: ")[2].replace("\n", " ")
    assert [name.strip() for name in missing.split(",")] == [handler.route.name for handler in REGISTRY.handlers]


@pytest.mark.slow
@pytest.mark.usefixtures("own_environment")
def test_a_single_message_that_does_not_cross_is_exit_code_1(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """One message of all is enough to fail, and it alone is named."""
    real = Crossing.add

    def all_but_one(crossing: Crossing, last: Any) -> None:
        if crossing.handler.route.name != "gps_info":
            real(crossing, last)

    monkeypatch.setattr(Crossing, "add", all_but_one)
    assert main(["demo", "--seconds", "1", "--middleware", "memory"]) == 1
    output = capsys.readouterr().out
    assert "20 of 21 messages were bridged" in output
    assert "not bridged: gps_info" in output


# --- its parts --------------------------------------------------------------------------------------------------


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


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ({}, ""),
        ({"a": 1, "b": True, "c": "x"}, "a 1, b True, c x"),
        ({"a": 1, "b": 2, "c": 3, "d": 4, "e": 5}, "a 1, b 2, c 3, d 4, …"),
        ({"a": {"x": 1.0, "y": 0.12345, "z": 3}, "b": [1, 2, 3]}, "a {1, 0.123…}, b [3]"),
    ],
)
def test_a_message_in_brief(values: dict[str, Any], text: str) -> None:
    """The first fields on one line, numbers short, nested messages and lists hinted at."""
    assert crossings.brief(values) == text


@pytest.mark.parametrize("handler", REGISTRY.handlers, ids=lambda handler: handler.route.name)
def test_simulated_payloads_fit_and_change(handler: Any) -> None:
    """Simulated payloads convert at any time, and do not stand still."""
    seen = {handler.to_cdr(payload_at(handler.payload_type, seconds / 3)) for seconds in range(30)}
    assert len(seen) > 1


def test_a_bridge_that_does_not_start_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Where the bridge's process ends before it is ready, its own words are shown, and the demo cannot run."""
    with pytest.raises(SetupError, match="the bridge process did not start"), BridgeProcess(tmp_path, "dds", {}):
        pass
    assert f"no generated code in {tmp_path}" in capsys.readouterr().err


class _Child:
    """A process that does not do as it is told."""

    def __init__(self, code: int | None) -> None:
        self._code = code

    def send_signal(self, number: int) -> None:
        pass

    def wait(self, timeout: float) -> int:
        if self._code is None:
            raise bridge_host.subprocess.TimeoutExpired("run", timeout)
        return self._code


@pytest.mark.parametrize(
    ("code", "expected"), [(None, "the bridge did not stop within 20"), (3, "the bridge ended with exit code 3")]
)
def test_a_bridge_that_does_not_end_well_is_told(code: int | None, expected: str) -> None:
    """A bridge that hangs or fails when it is stopped is an error of the demo's, not a traceback."""
    process = BridgeProcess(Path.cwd(), "dds", {})
    process._child = _Child(code)  # type: ignore[assignment]
    with pytest.raises(SetupError, match=expected):
        process.stop()


def test_a_bridge_in_a_thread_counts() -> None:
    """Over memory the bridge is a thread of this process; its account is the same."""
    with BridgeThread(REGISTRY, {"dst_a_port": 1, "dst_b_port": 2}) as host:
        assert host.port
        assert host.stop()["received"] == 0


def test_the_demo_keeps_to_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """It stays on this host, as each distribution calls that, and in a domain of its own unless one was chosen."""
    import os

    monkeypatch.setenv("ROS_LOCALHOST_ONLY", "0")
    monkeypatch.delenv("ROS_DOMAIN_ID", raising=False)
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
    monkeypatch.setenv("ROS_DISTRO", "jazzy")
    isolate_ros()
    assert os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] == "LOCALHOST"
    assert os.environ["ROS_LOCALHOST_ONLY"] == "0"
    monkeypatch.setenv("ROS_DISTRO", "humble")
    isolate_ros()
    assert os.environ["ROS_LOCALHOST_ONLY"] == "1"
    assert 0 < int(os.environ["ROS_DOMAIN_ID"]) <= 100
    monkeypatch.setenv("ROS_DOMAIN_ID", "7")
    isolate_ros()
    assert os.environ["ROS_DOMAIN_ID"] == "7"
