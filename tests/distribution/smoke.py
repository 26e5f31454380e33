"""Smoke test of the wheels and the sdists: `make test-dist`.

The wheels are installed into an environment that has nothing else. In an empty folder, roverlink must do the three
jobs of a user: edit the table and regenerate, lint in CI, and use the handlers in a program. And it must lint a
repository without a table, with the command in docs/lint.md. roverkit and check-launch must add their commands to it.
roverlink has its native core if there was a C++ compiler. Without one, what pip builds must work without the core.

Only the standard library of Python is there when this script starts. Exit code 0: all jobs passed; 1: a job failed.
"""

from __future__ import annotations

import contextlib
import json
import os
import platform
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

sys.path[:0] = map(str, Path(__file__).parents[1:3])
from default_signals import restore_default_signals  # noqa: E402  # not on the path of a script
from polling import PATIENCE_S  # noqa: E402

from roverlink.dds_domain import claim_domain  # noqa: E402

_NO_COMPILER = {"PATH": "", "CXX": ""}
_CONTAINER = """syntax = "proto3";
message ContainerInfo { float mass_grams = 1; bool lid_open = 2; }
"""
_ROW = "  - {number: 2, name: container_info, proto: ContainerInfo, topic: container_info, direction: board_to_ros}\n"
_ENVELOPE = """syntax = "proto3";
message Gps { double latitude = 1; double longitude = 2; }
message Imu { float heading = 1; }
message Wind { float speed = 1; }
message PBEnvelope { oneof payload { MEMBERS } }
"""
_PROGRAM = """
from generated.handlers import ContainerInfoHandler
from generated.registry import REGISTRY
from roverlink.runtime import Translator, load_registry

handler = ContainerInfoHandler()
payload = handler.payload_type(mass_grams=212.5, lid_open=True)
assert handler.to_ros(payload).mass_grams == 212.5
assert handler.from_cdr(handler.to_cdr(payload)) == payload
assert REGISTRY.by_number[2].route.topic == "container_info"
registry = load_registry()
envelope = registry.envelope(container_info=payload)
name, cdr = Translator(registry).receive(envelope.SerializeToString())
assert (name, cdr) == ("container_info", handler.to_cdr(payload))
"""
_CORE = """
from generated.registry import REGISTRY
from roverlink.runtime.native.core import NoCoreError, open_core

try:
    assert not open_core(REGISTRY).unsupported
    print("there is one")
except NoCoreError as error:
    print(error)
"""


class _JobError(Exception):
    """Raised when a command does not end or print as it should; the text has the command and its output."""


class _User:
    """A user with a new environment, a home and a folder, which are all empty."""

    def __init__(self, home: Path) -> None:
        self.folder = home / "rover"
        self._bin = home / "environment" / "bin"
        self._home = home
        self.variables = {"PATH": f"{self._bin}:/usr/bin:/bin", "HOME": str(home), "LANG": "C.UTF-8"}
        subprocess.run([sys.executable, "-m", "venv", home / "environment"], check=True)

    def pip(self, *options: object, **variables: str) -> None:
        """Run pip with the variables of the caller, for they say where pip gets packages, and with others."""
        pip = [self._bin / "python", "-m", "pip", "--quiet", "--disable-pip-version-check"]
        subprocess.run([*pip, *map(str, options)], cwd=self._home, check=True, env=os.environ | variables)

    def run(self, command: str, code: int = 0) -> str:
        """Run a command in the user's folder, and return what it printed. Raises `_JobError` for another exit code."""
        where = {"cwd": self.folder, "env": self.variables, "text": True}
        done = subprocess.run(shlex.split(command), **where, capture_output=True, timeout=PATIENCE_S)
        if done.returncode != code:
            raise _JobError(f"`{command}` ended with exit code {done.returncode}\n{done.stdout}{done.stderr}")
        return done.stdout

    @contextlib.contextmanager
    def running(self, command: str) -> Iterator[subprocess.Popen[str]]:
        """Run a command in the background, and end it with Ctrl-C."""
        where = {"cwd": self.folder, "env": self.variables, "text": True}
        process = subprocess.Popen(shlex.split(command), **where, stdout=subprocess.PIPE)
        try:
            yield process
        finally:
            process.send_signal(signal.SIGINT)
            process.communicate(timeout=PATIENCE_S)


def main(folder: Path) -> int:
    """Do the jobs with the wheels in a folder, then with its sdists and without a compiler. Return 1 if one fails."""
    restore_default_signals()
    with tempfile.TemporaryDirectory(prefix="roverlink-smoke-") as home:
        user = _User(Path(home))
        for kind in ("*.whl", "*.tar.gz"):
            # There may be a wheel of roverlink for another machine, too.
            ours = [
                path for path in folder.resolve().glob(kind) if path.stem.endswith((platform.machine(), "any", "tar"))
            ]
            roverlink, *others = sorted(ours, key=lambda path: (path.name[:9] != "roverlink", path))
            user.folder = Path(home, "rover of " + roverlink.name)
            user.folder.mkdir()
            start = time.monotonic()
            try:
                user.pip("uninstall", "--yes", "-qq", "roverlink", "roverkit", "check-launch")
                if kind == "*.whl":
                    user.pip("install", roverlink)
                    _edit_and_regenerate(user)
                    _lint_in_ci(user)
                    _lint_without_a_table(user)
                    user.pip("install", *others)
                else:
                    # Not what pip has built of an earlier sdist at the same path.
                    user.pip("install", "--no-cache-dir", roverlink, *others, **_NO_COMPILER)
                    _edit_and_regenerate(user)
                _use_the_handlers(user)
                _find_the_native_core(user, native=kind == "*.whl" and bool(shutil.which("c++")))
                _use_other_commands(user)
                if kind == "*.tar.gz" and sys.version_info < (3, 11):  # newer Pythons lack wheels of old packages
                    _use_the_oldest(user)
            except (_JobError, subprocess.SubprocessError, ValueError) as error:
                print(f"{roverlink.name} with Python {platform.python_version()}: {error}", file=sys.stderr)
                return 1
            seconds = time.monotonic() - start
            print(f"{roverlink.name} with Python {platform.python_version()}: passed in {seconds:.0f} s")
    return 0


def _edit_and_regenerate(user: _User) -> None:
    """Start a project, add a message to its table, and send it through the bridge."""
    user.run("roverlink --version")
    user.run("roverlink init")
    (user.folder / "proto" / "container.proto").write_text(_CONTAINER)
    table = user.folder / "mapping.yaml"
    table.write_text(table.read_text().replace("\nretired: []", _ROW + "\nretired: []"))
    if "for 2 messages" not in user.run("roverlink generate"):
        raise _JobError("`roverlink generate` does not know the new message")
    if platform.machine() == "x86_64" and sys.version_info < (3, 14):  # elsewhere, Cyclone DDS has no wheel
        _bridge(user)


def _bridge(user: _User) -> None:
    with contextlib.ExitStack() as stack:
        domain = str(claim_domain(stack))
        user.variables |= {"ROS_DOMAIN_ID": domain, "ROS_LOCALHOST_ONLY": "1"}
        bridge = stack.enter_context(
            user.running("roverlink run --json --ros-args -p listen_port:=0 --log-level error")
        )
        assert bridge.stdout is not None
        port = json.loads(bridge.stdout.readline())["port"]
        values = "mass_grams=212.5 lid_open=true"
        # Sent until the test ends, so that it does not matter when the bridge and the reader find each other.
        stack.enter_context(
            user.running(f"roverlink send container_info {values} --to 127.0.0.1:{port} --count 100000 --rate 10")
        )
        printed = user.run("roverlink echo container_info --count 1")
    if printed.split() != ["mass_grams:", "212.5", "lid_open:", "true", "---"]:
        raise _JobError(f"`roverlink echo` printed {printed!r}")


def _lint_in_ci(user: _User) -> None:
    """Find that a branch gives the number of the new message to another one."""
    user.variables |= {
        f"GIT_{who}_{what}": "user@example.com" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")
    }
    for command in ("init --quiet --initial-branch main", "add --all", "commit --quiet --message 'Start the rover'"):
        user.run(f"git {command}")
    user.run("roverlink generate --check")
    user.run("roverlink lint --against main --history")
    table = user.folder / "mapping.yaml"
    right = table.read_text()
    table.write_text(right.replace("proto: ContainerInfo", "proto: BoardStatus", 1))
    user.run("roverlink generate --check", code=1)
    found = user.run("roverlink lint --against main --history --format github", code=1)
    if "::error file=mapping.yaml" not in found:
        raise _JobError(f"`roverlink lint` does not report the reused number\n{found}")
    table.write_text(right)


def _use_the_handlers(user: _User) -> None:
    """Convert a message in a program that has its own main function."""
    (user.folder / "program.py").write_text(_PROGRAM)
    user.run("python program.py")


def _use_the_oldest(user: _User) -> None:
    """Generate with the oldest packages that the bounds allow, then run with the oldest protobuf, without protoc."""
    project = (Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8")
    needed = project.partition("[project.optional-")[0]
    bounds = dict(re.findall(r'^    "([a-z0-9-]+)>=([0-9.]+)', needed, re.MULTILINE))
    oldest = {name: bound if bound.count(".") else f"{bound}.0" for name, bound in bounds.items()}
    protobuf = oldest.pop("protobuf")
    user.pip("install", *(f"{name}=={bound}.*" for name, bound in oldest.items()))
    user.run("roverlink generate --check")
    user.pip("uninstall", "--yes", "-qq", "grpcio-tools")
    user.pip("install", f"protobuf=={protobuf}.*")
    _use_the_handlers(user)
    with user.running("roverlink run --json --middleware memory --ros-args -p listen_port:=0") as bridge:
        if not (bridge.stdout and "fingerprint" in bridge.stdout.readline()):
            raise _JobError(f"the bridge did not start with protobuf {protobuf}")


def _find_the_native_core(user: _User, *, native: bool) -> None:
    """Find out that the library is installed if it can be, and that it is told why it is not."""
    (user.folder / "core.py").write_text(_CORE)
    told = user.run("python core.py")
    if told.startswith("there is one") != native:
        raise _JobError(f"the native core: {told}")


def _lint_without_a_table(user: _User) -> None:
    """Find that a pull request gives a number of a repository without a table to another message, as a CI server does.

    The command is the one in docs/lint.md.
    """
    text = Path(__file__).parents[2].joinpath("docs", "lint.md").read_text(encoding="utf-8")
    command = next(line for line in text.splitlines() if "run: roverlink lint" in line).partition("run: ")[2]
    origin = user.folder / "origin"
    user.run("git init --quiet --initial-branch main origin")
    (origin / "protos").mkdir()
    _commit(user, "Start", "Gps gps = 1; Imu imu = 2;")
    _commit(user, "Remove the GPS", "Imu imu = 2;")
    user.run("git -C origin checkout --quiet -b wind")
    _commit(user, "Add the wind", "Imu imu = 2; Wind wind = 1;")
    user.run("git clone --quiet --branch wind origin clone")
    user.variables["GITHUB_BASE_REF"] = "main"
    found = user.run(f"sh -c 'cd clone && {command}'", code=1)
    if "::error file=protos/envelope.proto,line=5" not in found:
        raise _JobError(f"`{command}` does not report the reused number\n{found}")


def _use_other_commands(user: _User) -> None:
    """Call commands of roverkit and check-launch, by both names."""
    user.run("roverlink drive --help")
    (user.folder / "a_launch.yaml").write_text("launch:\n- node: {pkg: nav2_controller, exec: controller_serve}\n")
    for command in ("check-launch a_launch.yaml", "roverlink check-launch a_launch.yaml"):
        found = user.run(command, code=1)
        if "controller_server" not in found:
            raise _JobError(f"`{command}` does not report the misspelled executable\n{found}")


def _commit(user: _User, name: str, members: str) -> None:
    (user.folder / "origin" / "protos" / "envelope.proto").write_text(_ENVELOPE.replace("MEMBERS", members))
    user.run("git -C origin add --all")
    user.run(f"git -C origin commit --quiet --message '{name}'")


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
