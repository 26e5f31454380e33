"""The files with which a bridge runs on a rover, and what it tells the service manager that started it."""

from __future__ import annotations

import json
import shutil
import socket
import subprocess
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
def test_the_files_are_what_their_readers_take(printed: Printed, tmp_path: Path) -> None:
    """Systemd verifies the unit, hadolint the Dockerfile, where they are installed; the others are YAML and JSON."""
    compose = yaml.safe_load(printed("compose"))
    assert compose["services"]["bridge"]["network_mode"] == "host"
    lines = printed("devcontainer").splitlines()
    assert lines[0].startswith("//")
    assert json.loads("".join(line for line in lines if not line.startswith("//")))["image"] == "ros:humble"
    unit, dockerfile = printed("systemd"), printed("dockerfile")
    assert "COPY generated/ros/comms src/comms" in dockerfile
    if shutil.which("systemd-analyze"):
        (tmp_path / "comms.service").write_text(unit)
        done = subprocess.run(
            ["systemd-analyze", "verify", "--man=no", tmp_path / "comms.service"], capture_output=True, text=True
        )
        assert [line for line in done.stderr.splitlines() if "comms.service" in line] == []
    if shutil.which("hadolint"):
        subprocess.run(["hadolint", "--failure-threshold", "warning", "-"], input=dockerfile, text=True, check=True)


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
