"""Contestants: the programs that are measured.

All are child processes that listen on a UDP port. On SIGINT they stop and print their counts as one line of JSON.
"""

import importlib.util
import json
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import yaml

from bench import ros2
from bench.errors import BenchError
from bench.native import Programs
from bench.wire import IMU_STAMP

ROOT = Path(__file__).resolve().parents[1]


@dataclass(frozen=True, slots=True)
class Ports:
    """UDP ports of one rig, all on loopback: those of the bridge, the basestation (A) and the hardware (B)."""

    listen: int
    a: int
    b: int


@dataclass(frozen=True, slots=True)
class Contestant:
    """One way to build the bridge.

    `command` takes the ports, and whether each datagram is forwarded raw to A and B. `count` is the JSON key of the
    number of handled datagrams; the floor only receives. `rclpy` means that it publishes with rclpy, so load and
    observer do, too.
    """

    name: str
    about: str
    command: Callable[[Ports, bool], Sequence[str]]
    environment: Mapping[str, str] = field(default_factory=dict)
    count: str = "published"
    rclpy: bool = False

    @property
    def bridges(self) -> bool:
        """True if the program publishes what it receives."""
        return self.count != "received"

    def handled(self, counts: Mapping[str, Any]) -> int:
        """Return the number of received datagrams that the program has handled, by its own count."""
        handled = counts.get(self.count)
        if not isinstance(handled, int):
            raise BenchError(f"{self.name} did not print the count {self.count!r}: {dict(counts)}")
        return handled


@dataclass(frozen=True, slots=True)
class OurBridge(Contestant):
    """A `roverlink run`. `run` takes a project, parameters and further options, and returns the command."""

    run: Callable[[Path, Mapping[str, object], Sequence[str]], Sequence[str]] = field(kw_only=True)


def twin_without_core(name: str) -> str:
    """Return the name of the contestant that is as another one of ours, but without the native core."""
    return "rclpy-python" if name.startswith("rclpy") else "python"


@dataclass(frozen=True, slots=True)
class Site:
    """Inputs of the contestants: the C++ programs if they are built, the .proto tree, and the output folder."""

    programs: Programs | None
    proto: Path
    out: Path

    @property
    def python_protos(self) -> Path:
        """Folder of the protos' Python modules."""
        return self.out / "python"


def _floor(_site: Site) -> Contestant:
    stamp = (str(IMU_STAMP.high), str(IMU_STAMP.low))

    def command(ports: Ports, _forwards: bool) -> Sequence[str]:
        return (sys.executable, "-m", "bench.floor", str(ports.listen), *stamp)

    return Contestant("floor", "a Python socket, receive only", command, {"PYTHONPATH": str(ROOT)}, count="received")


def _cpp(site: Site) -> Contestant:
    if site.programs is None:
        raise BenchError("its C++ program is not built")
    reference = str(site.programs.reference)

    def command(ports: Ports, forwards: bool) -> Sequence[str]:
        return (reference, str(ports.listen), str(ports.a), str(ports.b), str(int(forwards)))

    return Contestant("cpp", "C++ with the system's libprotobuf and Cyclone DDS", command)


def _handwritten(site: Site) -> Contestant:
    if missing := [name for name in ("cyclonedds", "grpc_tools") if importlib.util.find_spec(name) is None]:
        raise BenchError(f"not installed: {', '.join(missing)}")

    def command(ports: Ports, forwards: bool) -> Sequence[str]:
        flags = ("--forward",) if forwards else ()
        return (sys.executable, "-m", "bench.handwritten", str(ports.listen), str(ports.a), str(ports.b), *flags)

    about = "Python, protobuf object to cyclonedds message class, field by field"
    return Contestant("handwritten", about, command, {"PYTHONPATH": f"{ROOT}:{site.python_protos}"})


def _roverlink(site: Site) -> Contestant:
    return _our_bridge("roverlink", "this project", site)


def _python(site: Site) -> Contestant:
    return _our_bridge("python", "this project without its native core", site)


def _rclpy(site: Site) -> Contestant:
    about = f"this project on ROS 2 {ros2.DISTRIBUTION.capitalize()} from PyPI, with rclpy and Fast DDS"
    return _our_bridge("rclpy", about, site)


def _rclpy_python(site: Site) -> Contestant:
    return _our_bridge("rclpy-python", "the same without the native core", site)


def _our_bridge(name: str, about: str, site: Site) -> OurBridge:
    """Return a contestant that is `roverlink run`; its name says with what."""
    rclpy, native = name.startswith("rclpy"), not name.endswith("python")
    if rclpy and not ros2.is_ready():
        raise BenchError("there is no ROS 2 in .ros2; `make test-ros2` makes it, on x86-64")
    program = [ros2.python(), "-m", "roverlink"] if rclpy else [str(_script())]
    same_work = site.out / "same-work"
    _compile_for_same_work(_script(), site.proto, same_work)

    def run(project: Path, parameters: Mapping[str, object], options: Sequence[str]) -> Sequence[str]:
        middleware = ("--middleware", "rclpy" if rclpy else "dds")
        given = {**parameters, "native_core": native}
        arguments = (word for one, value in given.items() for word in ("-p", f"{one}:={json.dumps(value)}"))
        return (*program, "run", "--project", str(project), *middleware, "--json", *options, "--ros-args", *arguments)

    def command(ports: Ports, forwards: bool) -> Sequence[str]:
        parameters = {
            "listen_port": ports.listen,
            "dst_ip": "127.0.0.1",
            "dst_a_port": ports.a,
            "dst_b_port": ports.b,
            "forward_policy": "all" if forwards else "mapping",
        }
        return run(same_work, parameters, ())

    environment = ros2.environment() if rclpy else {}
    return OurBridge(name, about, command, environment, rclpy=rclpy, run=run)


def _script() -> Path:
    script = Path(sys.executable).with_name("roverlink")
    if not script.exists():
        raise BenchError(f"{script} does not exist; `make bench` installs it")
    return script


@cache
def _compile_for_same_work(script: Path, proto: Path, project: Path) -> None:
    """Compile our table into a separate project, restricted to the work that the other contestants do.

    That is one topic for each row, and raw forwards only if the setting asks for them.
    """
    table = yaml.safe_load((ROOT / "mapping.yaml").read_text(encoding="utf-8"))
    for row in table["messages"]:
        row.pop("forward", None)
        row.pop("also", None)
    # The ledger of an earlier run would refuse rows whose forwards and extra topics were published, and without it,
    # `generate` would not replace translations.json.
    shutil.rmtree(project, ignore_errors=True)
    shutil.copytree(proto, project / table["proto"]["root"])
    mapping = project / "mapping.yaml"
    mapping.write_text(yaml.safe_dump(table, sort_keys=False), encoding="utf-8")
    command = (str(script), "generate", "--table", str(mapping))
    result = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603  # our own program
    if result.returncode != 0:
        raise BenchError(f"roverlink generate --table {mapping} failed:\n{result.stderr or result.stdout}")


# in the order of the report
FINDERS: dict[str, Callable[[Site], Contestant]] = {
    "floor": _floor,
    "cpp": _cpp,
    "handwritten": _handwritten,
    "roverlink": _roverlink,
    "python": _python,
    "rclpy": _rclpy,
    "rclpy-python": _rclpy_python,
}


def find_contestants(names: Iterable[str], site: Site) -> tuple[list[Contestant], list[str]]:
    """Return the contestants that can run here, and the reasons why the others cannot."""
    found, notes = [], []
    for name in names:
        try:
            found.append(FINDERS[name](site))
        except BenchError as error:
            notes.append(f"{name} is left out: {error}")
    return found, notes
