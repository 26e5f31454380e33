"""Environment of all sections: programs, contestants, environment variables, and length of measurements."""

import importlib.util
import os
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from bench import ros2
from bench.contestants import FINDERS, ROOT, Contestant, Site, find_contestants
from bench.errors import BenchError
from bench.native import Programs, build, missing_packages
from bench.process import Child
from bench.wire import compile_python, envelope_closure
from roverlink.dds_domain import UNTIL_EXIT, claim_domain

# Loopback has no multicast, so discovery needs an explicit peer.
CYCLONEDDS_ON_LOOPBACK = (
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address='127.0.0.1'/></Interfaces></General>"
    "<Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer address='localhost'/></Peers></Discovery>"
    "</Domain></CycloneDDS>"
)


@dataclass(frozen=True, slots=True)
class Lab:
    """Environment of a run.

    `seconds` is the length of a measurement, `notes` name missing parts, and `say` reports progress.
    """

    site: Site
    seconds: float
    quick: bool
    contestants: Sequence[Contestant]
    notes: Sequence[str]
    environment: dict[str, str]
    say: Callable[[str], None]

    def start(self, contestant: Contestant, command: Sequence[str]) -> Child:
        """Start a contestant."""
        return Child(contestant.name, command, {**self.environment, **contestant.environment}, self.site.out)

    def tool(self, name: str, *arguments: object) -> Child:
        """Start `load` or `observe`: the C++ program, or the Python one if that is not built."""
        program = getattr(self.site.programs, name, None)
        command = [str(program)] if program else [sys.executable, "-m", f"bench.{name}"]
        environment = {**self.environment, "PYTHONPATH": f"{ROOT}:{self.site.python_protos}"}
        return Child(name, [*command, *map(str, arguments)], environment, self.site.out)

    def rclpy_tool(self, name: str) -> Child:
        """Start `load` or `observe` with rclpy."""
        environment = {**self.environment, **ros2.environment()}
        return Child(name, [ros2.python(), "-m", "bench.rclpy_tools", name], environment, self.site.out)

    def rover_load(self, contestant: Contestant, *arguments: object) -> Child:
        """Start `rover_load` with the middleware of a contestant."""
        python, middleware = (ros2.python(), "rclpy") if contestant.rclpy else (sys.executable, "dds")
        environment = {**self.environment, **contestant.environment}
        command = [python, "-m", "bench.rover_load", middleware, *map(str, arguments)]
        return Child("rover_load", command, environment, self.site.out)


def prepare(
    *, proto: Path, out: Path, seconds: float, quick: bool, only: Sequence[str], say: Callable[[str], None]
) -> Lab:
    """Build the programs and find the contestants that can run. `only` names contestants; empty means all."""
    out.mkdir(parents=True, exist_ok=True)
    protos = envelope_closure(proto)
    programs, notes = _programs(protos, proto, out, say)
    site = Site(programs, proto, out)
    if importlib.util.find_spec("grpc_tools"):
        compile_python(protos, proto, site.python_protos)
    contestants, left_out = find_contestants(only or FINDERS, site)
    notes += left_out
    if not contestants:
        raise BenchError("\n".join(["no contestant can run", *notes]))
    return Lab(
        site=site,
        seconds=seconds,
        quick=quick,
        contestants=contestants,
        notes=notes,
        environment=_environment(),
        say=say,
    )


def _environment() -> dict[str, str]:
    # A domain of our own: no robot on the network listens to it, and two benchmarks at once do not share it.
    return {**os.environ, "CYCLONEDDS_URI": CYCLONEDDS_ON_LOOPBACK, "ROS_DOMAIN_ID": str(claim_domain(UNTIL_EXIT))}


def _programs(
    protos: Sequence[str], root: Path, out: Path, say: Callable[[str], None]
) -> tuple[Programs | None, list[str]]:
    if missing := missing_packages():
        return None, [
            f"load and observer are the slower Python ones; for those in C++: apt-get install {' '.join(missing)}"
        ]
    say("building the C++ programs")
    try:
        return build(protos, root, out / "native"), []
    except BenchError as error:
        return None, [f"load and observer are the slower Python ones: {error}"]
