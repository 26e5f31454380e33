"""Section `generation`: `roverlink generate` as a whole process, for our table and for tables of rising size."""

import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

from bench.contestants import ROOT
from bench.errors import BenchError
from bench.lab import Lab
from bench.result import Chart, Curve, Group, SectionResult, Table

SIZES = (30, 100, 300, 1_000)
QUICK_SIZES = (30, 100, 300)
FIELDS = 20
SCALARS = ("float", "double", "int32", "uint32", "int64", "bool", "string", "bytes", "sint32", "fixed64")


@dataclass(frozen=True, slots=True)
class Timing:
    """Times of one table: number of messages, and seconds of the first run and of a run without changes."""

    table: str
    messages: int
    first: float
    unchanged: float


def measure(lab: Lab) -> SectionResult:
    """Time our own table, then synthetic ones."""
    timings = [_timing(lab, "mapping.yaml", 21, own_project(lab.site.out / "generation" / "own"))]
    for timing in _synthetic(lab):
        timings.append(timing)
    rows = [
        [timing.table, f"{timing.first:.2f}", f"{timing.unchanged:.2f}", f"{1000 * timing.first / timing.messages:.1f}"]
        for timing in timings
    ]
    columns = ("", "first run, s", "unchanged run, s", "ms per message")
    notes = [
        f"Whole processes. Synthetic messages have {FIELDS} fields. If the last column stays constant, time is linear."
    ]
    return SectionResult(
        tables=[Table("Compiling a table", columns, [Group("", rows)], notes)],
        charts=[_chart(timings[1:])],
        data={"timings": [asdict(timing) for timing in timings]},
    )


def _chart(timings: list[Timing]) -> Chart:
    sizes = [timing.messages for timing in timings]
    curves = [
        Curve("first run", sizes, [timing.first for timing in timings]),
        Curve("unchanged", sizes, [timing.unchanged for timing in timings]),
    ]
    return Chart(f"Compiling a table (messages of {FIELDS} fields)", "messages", "s", curves)


def _synthetic(lab: Lab) -> Iterator[Timing]:
    for size in QUICK_SIZES if lab.quick else SIZES:
        project = _synthetic_project(lab.site.out / "generation" / str(size), size)
        yield _timing(lab, f"{size} messages", size, project)


def _timing(lab: Lab, table: str, messages: int, project: Path) -> Timing:
    timing = Timing(table, messages, _generate(project), _generate(project))
    lab.say(f"generation {table}: {timing.first:.2f} s, unchanged {timing.unchanged:.2f} s")
    return timing


def _generate(project: Path) -> float:
    command = (sys.executable, "-m", "roverlink", "generate", "--table", str(project / "mapping.yaml"))
    start = time.perf_counter()
    done = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603  # our own program
    if done.returncode:
        raise BenchError(f"roverlink generate failed in {project}:\n{done.stderr}")
    return time.perf_counter() - start


def own_project(project: Path) -> Path:
    """Copy our own table, protos and ledger to a folder."""
    shutil.rmtree(project, ignore_errors=True)
    shutil.copytree(ROOT / "proto", project / "proto")
    for name in ("mapping.yaml", "mapping.lock"):
        shutil.copy(ROOT / name, project)
    return project


def _synthetic_project(project: Path, size: int) -> Path:
    shutil.rmtree(project, ignore_errors=True)
    protos = project / "proto" / "board"
    protos.mkdir(parents=True)
    for index in range(1, size + 1):
        fields = (f"  {SCALARS[k % len(SCALARS)]} field_{k} = {k};" for k in range(1, FIELDS + 1))
        text = "\n".join(['syntax = "proto3";', f"message BoardMessage{index} {{", *fields, "}", ""])
        (protos / f"message_{index}.proto").write_text(text, encoding="utf-8")
    rows = (
        f"  - {{number: {index}, name: message_{index}, proto: BoardMessage{index}, topic: topic_{index}, "
        "direction: hardware_to_ros}"
        for index in range(1, size + 1)
    )
    head = (
        "version: 1",
        "proto: {root: proto}",
        "envelope: {file: board/envelope.proto, message: Envelope, oneof: payload}",
        "ros: {package: comms}",
        "peers: {hardware: {prefixes: [Board]}}",
        "messages:",
    )
    (project / "mapping.yaml").write_text("\n".join([*head, *rows, ""]), encoding="utf-8")
    return project
