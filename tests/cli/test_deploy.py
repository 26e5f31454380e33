"""The files with which a bridge runs on a rover, and what it tells the service manager that started it."""

from __future__ import annotations

import json
import shutil
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import yaml
from polling import wait_until
from programs import Start

from roverlink.runtime.bridge import service_manager

Printed = Callable[[str], str]


@pytest.fixture
def printed(done: Start) -> Printed:
    """Returns what `roverlink deploy --print` prints for the sample rover."""
    return lambda kind: str(done("deploy", "--print", kind)[1]) + "\n"


@pytest.fixture
def notified(tmp_path: Path, environment: dict[str, str], monkeypatch: pytest.MonkeyPatch) -> Iterator[socket.socket]:
    """The socket of a service manager, which a program of the test is told to use."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
        manager.bind(str(tmp_path / "notify"))
        monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "notify"))
        environment["NOTIFY_SOCKET"] = str(tmp_path / "notify")
        yield manager


@pytest.mark.slow
def test_the_files_for_containers_are_what_their_readers_take(printed: Printed) -> None:
    """They are YAML and JSON, and start what is there."""
    compose = yaml.safe_load(printed("compose"))
    assert compose["services"]["bridge"]["network_mode"] == "host"
    lines = printed("devcontainer").splitlines()
    assert lines[0].startswith("//")
    assert json.loads("".join(line for line in lines if not line.startswith("//")))["image"] == "ros:humble"
    assert "COPY generated/ros/comms src/comms" in printed("dockerfile")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "name", "judge"),
    [
        ("systemd", "comms.service", "systemd-analyze verify --man=no"),
        ("dockerfile", "Dockerfile", "hadolint --failure-threshold warning --no-color"),
    ],
)
def test_judges_find_nothing(printed: Printed, tmp_path: Path, kind: str, name: str, judge: str) -> None:
    """Systemd verifies the unit, and hadolint the Dockerfile."""
    tool, *options = judge.split()
    found = shutil.which(tool) or shutil.which(tool, path=Path(sys.executable).parent)
    if found is None:
        pytest.skip(f"need {tool} (make test-all)")
    (tmp_path / name).write_text(printed(kind))
    done = subprocess.run([found, *options, tmp_path / name], capture_output=True, text=True)
    told = [line for line in (done.stdout + done.stderr).splitlines() if name in line and " info: " not in line]
    assert told == []


@pytest.mark.slow
def test_a_bridge_tells_the_service_manager_how_it_is(
    notified: socket.socket, start: Start, environment: dict[str, str]
) -> None:
    """It is ready when it can receive, alive as long as its threads are, and stopping at the end."""
    environment["WATCHDOG_USEC"] = "400000"
    notified.settimeout(60)
    bridge = start("run", "--middleware", "memory", "--ros-args", "-p", "listen_port:=0")
    told = [notified.recv(64) for _ in range(5)]
    assert b"READY=1" in told[:2]
    assert told.count(b"WATCHDOG=1") == 4
    bridge.interrupt()
    wait_until(lambda: notified.recv(64) == b"STOPPING=1", "the end")


def test_a_bridge_that_hangs_gives_no_sign_of_life(notified: socket.socket) -> None:
    """The timer thread is silent as soon as the thread that receives makes no progress, and speaks when it does."""
    notified.setblocking(False)
    progress = 0
    heartbeat = service_manager.Heartbeat(4.0, lambda: progress)
    said = []
    for now in range(6):
        progress += now in (0, 1, 4)
        heartbeat.run_due(float(now))
        try:
            said.append(notified.recv(64) == b"WATCHDOG=1")
        except BlockingIOError:
            said.append(False)
    assert said == [True, True, False, False, True, False]
