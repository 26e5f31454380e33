"""Section `rover`: all rows of a table at once, as a rover sends them, and what the other features add to it."""

import contextlib
import shutil
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from bench.contestants import ROOT, OurBridge, twin_without_core
from bench.errors import BenchError
from bench.lab import Lab
from bench.process import wait_until_bound
from bench.result import Group, SectionResult, Table
from bench.rig import free_port

RATE = 5_000
WARM_UP_SECONDS, SETTLE_SECONDS = 0.5, 0.3
SECONDS_FACTOR = 5.0  # commands and link messages come seldom
_FULL_PROJECT = ROOT / "tests" / "soak" / "full_project.py"
_RECORDER = ("--record", "{folder}/run.mcap")


@dataclass(frozen=True, slots=True)
class Case:
    """Work of a bridge: with `full`, all that a table can ask for; `options` of `roverlink run`; 0: usual rates."""

    heading: str
    rate: int = RATE
    full: bool = False
    options: Sequence[str] = ()


PLAIN = Case(f"the sample table, {RATE:,}/s")
EVERYTHING = Case(
    f"signatures, deadmen, links and limits, {RATE:,}/s, recorder and page",
    full=True,
    options=(*_RECORDER, "--page", "0"),
)
CASES = (
    Case("the sample table, each row at the rate of `roverlink simulate`", rate=0),
    PLAIN,
    Case(f"the sample table, {RATE:,}/s, recorder", options=_RECORDER),
    EVERYTHING,
)
QUICK_CASES = (PLAIN, EVERYTHING)


@dataclass(frozen=True, slots=True)
class Cost:
    """Measured cost of a case with a bridge."""

    case: str
    contestant: str
    per_second: float
    lost: int
    cpu_us: float
    megabytes: float


NOTES = (
    "CPU: of the whole process with recorder and page, per datagram and command. Nobody subscribes or opens the page.",
    f"As multiples, vs python: of the same without the native core; vs plain: of the sample table at {RATE:,}/s.",
    "+us: CPU beyond that of the sample table at the same rate; with the recorder alone, what that costs.",
)


def measure(lab: Lab) -> SectionResult:
    """Run each case with each contestant that is ours."""
    ours = [contestant for contestant in lab.contestants if isinstance(contestant, OurBridge)]
    costs: dict[tuple[str, str], Cost] = {}
    notes = [*NOTES]
    cases = QUICK_CASES if lab.quick else CASES
    for case in cases:
        for contestant in ours:
            try:
                cost = costs[case.heading, contestant.name] = _cost(lab, case, contestant)
            except BenchError as error:  # an optional package is not installed
                notes.append(f"{contestant.name} is left out of {case.heading}: {str(error).splitlines()[-1].strip()}")
                lab.say(notes[-1])
            else:
                lab.say(f"{contestant.name:>20} {cost.cpu_us:.1f} us, {cost.lost} lost: {case.heading}")
    groups = [Group(case.heading, _rows(costs, case)) for case in cases]
    table = Table("A whole rover", _COLUMNS, groups, notes)
    return SectionResult([table] if ours else [], data={"costs": [*map(asdict, costs.values())]})


_COLUMNS = ("", "1/s", "lost", "CPU us", "vs python", "vs plain", "+us", "MB")


def _rows(costs: dict[tuple[str, str], Cost], case: Case) -> list[Sequence[str]]:
    found: list[Sequence[str]] = []
    for own in (cost for (heading, _), cost in costs.items() if heading == case.heading):
        python = costs.get((case.heading, twin_without_core(own.contestant)), own)
        plain = own if case.rate != RATE else costs.get((PLAIN.heading, own.contestant), own)
        vs_python, vs_plain = ("-" if one is own else f"{own.cpu_us / one.cpu_us:.2f}" for one in (python, plain))
        more = "-" if plain is own else f"{own.cpu_us - plain.cpu_us:.2f}"
        numbers = (f"{own.per_second:,.0f}", str(own.lost), f"{own.cpu_us:.1f}", vs_python, vs_plain, more)
        found.append((own.contestant, *numbers, f"{own.megabytes:.0f}"))
    return found


def _cost(lab: Lab, case: Case, contestant: OurBridge) -> Cost:
    folder, port, seconds = lab.site.out / "rover", free_port(), lab.seconds * SECONDS_FACTOR
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "keys").mkdir(parents=True)
    project = _full_project(folder / "full") if case.full else ROOT
    with contextlib.ExitStack() as stack:
        load = stack.enter_context(
            lab.rover_load(contestant, project, port, case.rate, seconds + WARM_UP_SECONDS, folder / "keys")
        )
        given = load.ask("")
        options = [option.format(folder=folder) for option in case.options]
        options += [word for file in given["keys"] for word in ("--key-file", file)]
        command = contestant.run(project, {**given["parameters"], "listen_port": port}, options)
        bridge = stack.enter_context(lab.start(contestant, command))
        wait_until_bound(bridge, port)
        warmed = load.ask(f"{WARM_UP_SECONDS}")
        used = bridge.cpu_seconds()
        offered = load.ask(f"{seconds}")
        used = bridge.cpu_seconds() - used
        time.sleep(SETTLE_SECONDS)
        megabytes = bridge.resident_mb()
        counts = bridge.stop()
    return Cost(
        case=case.heading,
        contestant=contestant.name,
        per_second=offered["sent"] / offered["seconds"],
        lost=warmed["sent"] + offered["sent"] - counts["received"],
        cpu_us=used / (offered["sent"] + offered["commands"]) * 1e6,
        megabytes=megabytes,
    )


def _full_project(folder: Path) -> Path:
    command = (sys.executable, str(_FULL_PROJECT), str(folder))
    done = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603  # our own program
    if done.returncode:
        raise BenchError(f"{_FULL_PROJECT} failed:\n{done.stderr}")
    return folder
