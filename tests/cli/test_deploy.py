"""The files with which a bridge runs on a rover, and what it tells the service manager that started it."""

from __future__ import annotations

import json
import shlex
import shutil
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import yaml
from polling import PATIENCE_S, wait_until
from programs import Start
from signed_project import make_signed_project

from roverlink.__main__ import main
from roverlink.runtime.bridge import service_manager

Printed = Callable[[str], str]


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The sample rover, but its basestation must sign, and its boards are at a serial line."""
    table = make_signed_project(tmp_path_factory.mktemp("deploy") / "rover")
    text = table.read_text(encoding="utf-8")
    assert "\n  hardware:\n" in text
    table.write_text(
        text.replace("\n  hardware:\n", "\n  hardware:\n    host: serial:/dev/ttyACM0\n"), encoding="utf-8"
    )
    assert main(["generate", "--table", str(table)]) == 0
    return table.parent


@pytest.fixture
def printed(done: Start, project: Path) -> Printed:
    """Returns what `roverlink deploy --print` prints for the project."""
    return lambda kind: str(done("deploy", "--project", project, "--print", kind)[1]) + "\n"


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
    """They are YAML and JSON, start what is there, and give it the keys and the devices of the table."""
    service = yaml.safe_load(printed("compose"))["services"]["bridge"]
    assert service["network_mode"] == "host"
    assert service["command"][-2:] == ["--key-file", "keys/basestation.keys"]
    assert {"./keys:/home/rover/keys", "/dev:/dev"} < {*service["volumes"]}
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
        ("compose", "compose.yaml", "check-jsonschema --builtin-schema vendor.compose-spec --output-format text"),
    ],
)
def test_judges_find_nothing(printed: Printed, tmp_path: Path, kind: str, name: str, judge: str) -> None:
    """Systemd verifies the unit, hadolint the Dockerfile, and the schema of Compose its file."""
    tool, *options = judge.split()
    found = shutil.which(tool) or shutil.which(tool, path=Path(sys.executable).parent)
    if found is None:
        pytest.skip(f"need {tool} (make test-all)")
    (tmp_path / name).write_text(printed(kind))
    done = subprocess.run([found, *options, tmp_path / name], capture_output=True, text=True)
    told = [line for line in (done.stdout + done.stderr).splitlines() if name in line and " info: " not in line]
    assert told == []


@pytest.mark.slow
def test_the_unit_starts_a_bridge_that_must_sign(printed: Printed, project: Path, start: Start, tmp_path: Path) -> None:
    """With the keys where the unit's first lines put them, its options start the bridge, and so do the launch files."""
    unit = printed("systemd").replace("/var/lib/comms", str(tmp_path))
    (installed,) = (line.split()[-2:] for line in unit.splitlines() if line.startswith("#   sudo install -D"))
    assert main(["link", "keygen", "basestation", "--out", installed[1]]) == 0
    (tmp_path / "recordings").mkdir()
    _, _, options = unit.replace("\\\n", "").partition("/comms_node ")
    words = shlex.split(options.partition("--ros-args")[0])
    bridge = start("run", "--project", project, "--middleware", "memory", *words, "--ros-args", "-p", "listen_port:=0")
    bridge.wait_for("bridges 21 messages")
    package = project / "generated" / "ros" / "comms"
    (node,) = (
        action["node"]
        for action in yaml.safe_load((package / "launch" / "comms_launch.yaml").read_text())["launch"][-1]["group"]
        if "node" in action
    )
    assert node["args"] == "--middleware $(var middleware) --key-file $(var basestation_keys)"
    assert '"--key-file",' in (package / "launch" / "comms.launch.py").read_text()
    assert "python3-serial</exec_depend>" in (package / "package.xml").read_text()


@pytest.mark.slow
def test_a_bridge_tells_the_service_manager_how_it_is(
    notified: socket.socket, start: Start, environment: dict[str, str]
) -> None:
    """It is ready when it can receive, alive as long as its threads are, and stopping at the end."""
    environment["WATCHDOG_USEC"] = "400000"
    notified.settimeout(PATIENCE_S)
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
