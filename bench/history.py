"""The section `history`: `roverlink lint --history` as a whole process, over histories of rising length."""

import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

from bench.errors import BenchError
from bench.lab import Lab
from bench.result import Chart, Curve, Group, SectionResult, Table

SIZES = (100, 1_000, 2_000, 10_000)
QUICK_SIZES = (100, 1_000)
MEMBERS = 40
"""Members of the envelope, of which each commit takes one away and puts another in."""
_FIRST = 1_770_000_000  # 2026-02-02
_ENVELOPE = "components/common/envelope.proto"


@dataclass(frozen=True, slots=True)
class Timing:
    """One history: how many commits, and the seconds of the scan."""

    commits: int
    seconds: float


def measure(lab: Lab) -> SectionResult:
    """Time histories in which every commit changes the envelope."""
    timings = []
    for commits in QUICK_SIZES if lab.quick else SIZES:
        repository = _repository(lab.site.out / "history" / str(commits), commits)
        timings.append(Timing(commits, _scan(repository)))
        lab.say(f"history {commits} commits: {timings[-1].seconds:.2f} s")
    rows = [[str(one.commits), f"{one.seconds:.2f}", f"{1000 * one.seconds / one.commits:.2f}"] for one in timings]
    notes = [f"Whole processes. Every commit changes the envelope, which has {MEMBERS} members."]
    curve = Curve("roverlink", [one.commits for one in timings], [one.seconds for one in timings])
    return SectionResult(
        tables=[Table("Linting a history", ("commits", "s", "ms a commit"), [Group("", rows)], notes)],
        charts=[Chart("Linting a history", "commits", "s", [curve])],
        data={"timings": [asdict(timing) for timing in timings]},
    )


def _scan(repository: Path) -> float:
    command = [sys.executable, "-m", "roverlink", "lint", "--history", str(repository), "--message", "PBEnvelope"]
    start = time.perf_counter()
    done = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603  # our own program
    if done.returncode != 1:
        raise BenchError(f"{' '.join(command)} finds nothing, or cannot run:\n{done.stdout[-500:]}{done.stderr}")
    return time.perf_counter() - start


def _repository(folder: Path, commits: int) -> Path:
    """A bare history, made by git fast-import."""
    folder.mkdir(parents=True, exist_ok=True)
    stream = "\n".join([*_stream(commits), "done\n"]).encode()
    for arguments in (["init", "--quiet"], ["fast-import", "--quiet", "--force"]):
        command = ["git", "-C", str(folder), *arguments]
        done = subprocess.run(command, input=stream, capture_output=True, check=False)  # noqa: S603  # git, no shell
        if done.returncode:
            raise BenchError(f"git {arguments[0]} fails:\n{done.stderr.decode()}")
    return folder


def _stream(commits: int) -> Iterator[str]:
    for index in range(commits):
        text = _envelope(index)
        person = f"A B <a@example.com> {_FIRST + 3600 * index} +0000"
        yield f"commit refs/heads/main\nauthor {person}\ncommitter {person}\ndata 6\nChange"
        yield f"M 100644 inline {_ENVELOPE}\ndata {len(text)}\n{text}"


def _envelope(index: int) -> str:
    """The envelope of one commit: a window of payloads that moves on by one, over numbers that come round again."""
    numbers = range(index, index + MEMBERS)
    members = (
        f"    Payload{k % (3 * MEMBERS)} payload_{k % (3 * MEMBERS)} = {k % (2 * MEMBERS) + 1};" for k in numbers
    )
    return "\n".join(['syntax = "proto3";', "", "message PBEnvelope {", "  oneof payload {", *members, "  }", "}", ""])
