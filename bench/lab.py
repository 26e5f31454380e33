"""What every section of the bench works with: programs, contestants, environment, and how long to measure."""

import importlib.util
import os
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from bench.contestants import FINDERS, ROOT, Contestant, Site, find_contestants
from bench.errors import BenchError
from bench.native import Programs, build, missing_packages
from bench.process import Child
from bench.wire import compile_python, envelope_closure

# The loopback interface, and the peer without which nothing is discovered there: loopback has no multicast.
CYCLONEDDS_ON_LOOPBACK = (
    "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address='127.0.0.1'/></Interfaces></General>"
    "<Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer address='localhost'/></Peers></Discovery>"
    "</Domain></CycloneDDS>"
)


@dataclass(frozen=True, slots=True)
class Lab:
    """`seconds` is the length of a measuring point; `notes` say what is missing; `say` reports progress."""

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
        """Start `load` or `observe`: the C++ one, or the Python one where it is not built."""
        program = getattr(self.site.programs, name) if self.site.programs else None
        command = [str(program)] if program else [sys.executable, "-m", f"bench.{name}"]
        environment = {**self.environment, "PYTHONPATH": f"{ROOT}:{self.site.python_protos}"}
        return Child(name, [*command, *map(str, arguments)], environment, self.site.out)


def prepare(
    *, proto: Path, out: Path, seconds: float, quick: bool, only: Sequence[str], say: Callable[[str], None]
) -> Lab:
    """Build what can be built and find who can take part. `only` names contestants; none means all."""
    out.mkdir(parents=True, exist_ok=True)
    protos = envelope_closure(proto)
    programs, notes = _programs(protos, proto, out, say)
    site = Site(programs, proto, out)
    if importlib.util.find_spec("grpc_tools"):
        compile_python(protos, proto, site.python_protos)
    contestants, left_out = find_contestants(only or FINDERS, site)
    notes += left_out
    if not contestants:
        raise BenchError("\n".join(["there is nobody to measure", *notes]))
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
    # A domain of our own: no robot on the network listens to it, and two benches at once rarely share it. Numbers
    # above 100 would put DDS's ports among those that the system hands out.
    return {**os.environ, "CYCLONEDDS_URI": CYCLONEDDS_ON_LOOPBACK, "ROS_DOMAIN_ID": str(20 + os.getpid() % 80)}


def _programs(
    protos: Sequence[str], root: Path, out: Path, say: Callable[[str], None]
) -> tuple[Programs | None, list[str]]:
    if missing := missing_packages():
        return None, [
            f"load and observers are in Python, slower; for those in C++: apt-get install {' '.join(missing)}"
        ]
    say("building the C++ programs")
    try:
        return build(protos, root, out / "native"), []
    except BenchError as error:
        return None, [f"load and observers are in Python, slower: {error}"]
