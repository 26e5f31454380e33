"""`roverlink demo`, and the parts of which it is made."""

from __future__ import annotations

import io
import os
import re
import sys
import time
from contextlib import ExitStack
from pathlib import Path
from unittest.mock import Mock

import pytest
from rich.console import Console
from running import Called

from generated.registry import REGISTRY
from roverlink.__main__ import main
from roverlink.commands import demo
from roverlink.console import isolate_ros
from roverlink.runtime import SetupError
from roverlink.simulation import crossings
from roverlink.simulation.bridge_host import BridgeProcess
from roverlink.simulation.crossings import Crossing


@pytest.fixture(autouse=True)
def _own_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the demo does to the environment ends with the test; no other package adds parts to the demo."""
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.setattr(demo, "entry_points", lambda group: ())


@pytest.mark.slow
def test_every_message_crosses(called: Called) -> None:
    """In three seconds all messages cross, it ends by itself with exit code 0, and says what the bridge counted."""
    code, output, errors = called("demo", "--seconds", 3, "--middleware", "memory")
    assert code == 0, output
    # where the processor is shared with many, commands come late, which the bridge has to say
    assert [line for line in errors.splitlines() if "the topic is silent" not in line] == []

    def numbers(pattern: str) -> list[float]:
        found = re.search(pattern, output)
        assert found, f"{pattern}\n{output}"
        return [*map(float, found.groups())]

    crossed, forwarded = numbers(r"21 of 21 messages bridged, (\d+) times in all; (\d+) datagrams forwarded")
    assert crossed >= 21
    assert forwarded >= 12
    received, published = numbers(r"counters of the bridge: received (\d+), published (\d+), sent \d+, forwarded \d+")
    assert received == published > 0
    assert "not bridged" not in output
    for handler in REGISTRY.handlers:
        assert re.search(rf"{handler.route.number} . {handler.route.name} ", output)


@pytest.mark.slow
def test_messages_that_do_not_cross_are_exit_code_1(capsys: pytest.CaptureFixture[str]) -> None:
    """Without any time nothing crosses: each message is named, and the exit code is 1."""
    assert main(["demo", "--seconds", "0", "--middleware", "memory"]) == 1
    output = capsys.readouterr().out
    assert "0 of 21 messages bridged" in output
    missing = output.partition("not bridged: ")[2].replace("\n", " ")
    assert [name.strip() for name in missing.split(",")] == [handler.route.name for handler in REGISTRY.handlers]


def test_an_interrupted_demo_is_exit_code_130(monkeypatch: pytest.MonkeyPatch) -> None:
    """A script does not take it for a demo that has shown all messages."""
    monkeypatch.setattr(demo, "bridge_with", Mock(side_effect=KeyboardInterrupt))
    assert main(["demo", "--middleware", "memory"]) == 130


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
