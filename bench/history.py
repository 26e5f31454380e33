"""Section `history`: `roverlink lint --history` as a whole process, over histories of rising length."""

import os
import resource
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

from bench.errors import BenchError
from bench.lab import Lab
from bench.result import Chart, Curve, Group, SectionResult, Table

SIZES = (100, 1_000, 2_000, 10_000, 25_000)
QUICK_SIZES = (100, 1_000)
MEMBERS = 40
"""Members of the envelope; each commit removes one and adds another."""
_FIRST = 1_770_000_000  # 2026-02-02
_ENVELOPE = "components/common/envelope.proto"


@dataclass(frozen=True, slots=True)
class Timing:
    """Times of one history: number of commits, and CPU seconds of a first scan, of a second one, and of `git log`."""

    commits: int
    cold: float
    warm: float
    log: float


def measure(lab: Lab) -> SectionResult:
    """Time histories in which three of four commits change the envelope, with and without a cache."""
    timings = []
    for commits in QUICK_SIZES if lab.quick else SIZES:
        folder = lab.site.out / "history" / str(commits)
        repository = _repository(folder / "repository", commits)
        shutil.rmtree(folder / "cache", ignore_errors=True)
        cold, warm = (_scan(repository, folder / "cache") for _ in range(2))
        timings.append(Timing(commits, cold, warm, _log(repository)))
        lab.say(f"history {commits} commits: {timings[-1].cold:.2f} s of CPU, then {timings[-1].warm:.2f} s")
    rows = [
        [
            str(one.commits),
            f"{one.cold:.2f}",
            f"{one.warm:.2f}",
            f"{1000 * one.cold / one.commits:.2f}",
            f"{one.log:.2f}",
        ]
        for one in timings
    ]
    notes = [
        "CPU time of whole processes, git's included; cold is the first run, without a cache.",
        "`git log --all -p -- '*.proto'` prints the same changes, for comparison.",
        f"Three of four commits change the envelope, which has {MEMBERS} members; all its states differ.",
    ]
    sizes = [one.commits for one in timings]
    curves = [Curve("cold", sizes, [one.cold for one in timings]), Curve("warm", sizes, [one.warm for one in timings])]
    columns = ("commits", "cold, s", "warm, s", "cold, ms per commit", "git log -p, s")
    return SectionResult(
        tables=[Table("Linting a history", columns, [Group("", rows)], notes)],
        charts=[Chart("Linting a history", "commits", "s", curves)],
        data={"timings": [asdict(timing) for timing in timings]},
    )


def _scan(repository: Path, cache: Path) -> float:
    """Lint a history; return the CPU seconds."""
    command = [sys.executable, "-m", "roverlink", "lint", "--history", str(repository), "--message", "PBEnvelope"]
    environment = {**os.environ, "XDG_CACHE_HOME": str(cache.resolve())}
    before = _cpu_of_children()
    done = subprocess.run(  # noqa: S603  # our own program
        command, capture_output=True, text=True, check=False, env=environment
    )
    if done.returncode != 1:
        raise BenchError(f"{' '.join(command)} found nothing or could not run:\n{done.stdout[-500:]}{done.stderr}")
    return _cpu_of_children() - before


def _log(repository: Path) -> float:
    """Print the changes of all .proto files with git; return the CPU seconds."""
    before = _cpu_of_children()
    command = ["git", "-C", str(repository), "log", "--all", "-p", "--", "*.proto"]
    subprocess.run(command, stdout=subprocess.DEVNULL, check=True)  # noqa: S603  # git, no shell
    return _cpu_of_children() - before


def _cpu_of_children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _repository(folder: Path, commits: int) -> Path:
    """Make a repository with git fast-import."""
    folder.mkdir(parents=True, exist_ok=True)
    stream = "\n".join([*_stream(commits), "done\n"]).encode()
    for arguments in (["init", "--quiet"], ["fast-import", "--quiet", "--force"]):
        command = ["git", "-C", str(folder), *arguments]
        done = subprocess.run(command, input=stream, capture_output=True, check=False)  # noqa: S603  # git, no shell
        if done.returncode:
            raise BenchError(f"git {arguments[0]} failed:\n{done.stderr.decode()}")
    return folder


def _stream(commits: int) -> Iterator[str]:
    for index in range(commits):
        path, text = (_ENVELOPE, _envelope(index)) if index % 4 else ("README.md", f"{index}\n")
        person = f"A B <a@example.com> {_FIRST + 3600 * index} +0000"
        yield f"commit refs/heads/main\nauthor {person}\ncommitter {person}\ndata 6\nChange"
        yield f"M 100644 inline {path}\ndata {len(text)}\n{text}"


def _envelope(index: int) -> str:
    """Return the envelope of one commit: a window of payloads that moves by one, over repeating numbers."""
    numbers = range(index, index + MEMBERS)
    members = (
        f"    Payload{k % (3 * MEMBERS)} payload_{k % (3 * MEMBERS)} = {k % (2 * MEMBERS) + 1};" for k in numbers
    )
    return "\n".join(
        [
            'syntax = "proto3";',
            f"// State {index}.",
            "message PBEnvelope {",
            "  oneof payload {",
            *members,
            "  }",
            "}",
            "",
        ]
    )
