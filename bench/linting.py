"""Section `linting`: `roverlink lint` as a whole process, compared with `buf breaking` on the same change."""

import json
import shutil
import statistics
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from bench.errors import BenchError
from bench.generation import own_project
from bench.lab import Lab
from bench.result import Group, SectionResult, Table

RUNS, QUICK_RUNS = 15, 5
# A change that both find: a field of the IMU's message gets another type.
_CHANGED_FILE, _BEFORE, _AFTER = "components/sensor_board/imu_sensor.proto", "float accel_x", "double accel_x"
_BUF_CONFIG = json.dumps({"version": "v2", "breaking": {"use": ["FILE", "WIRE_JSON", "WIRE"]}})
_FINDINGS = (1, 100)  # exit codes for findings: roverlink's and buf's


@dataclass(frozen=True, slots=True)
class Timing:
    """Times of one command as a whole process: the shortest and the median in seconds."""

    command: str
    shortest: float
    median: float


def measure(lab: Lab) -> SectionResult:
    """Time the lint of our own table, alone and against a state in which one field had another type."""
    folder = lab.site.out / "linting"
    project, before = own_project(folder / "project"), own_project(folder / "before")
    changed = project / "proto" / _CHANGED_FILE
    changed.write_text(changed.read_text(encoding="utf-8").replace(_BEFORE, _AFTER), encoding="utf-8")
    lint = [sys.executable, "-m", "roverlink", "lint", "--table", str(project / "mapping.yaml"), "--format", "json"]
    commands: dict[str, Sequence[str]] = {
        "roverlink lint": lint,
        "roverlink lint --against": [*lint, "--against", str(before)],
    }
    notes = ["Whole processes over 21 messages; one field has another type than in the baseline."]
    if buf := _buf():
        against = ["--against", str(before / "proto"), "--config", _BUF_CONFIG, "--against-config", '{"version": "v2"}']
        commands["buf breaking"] = [buf, "breaking", str(project / "proto"), *against]
    else:
        notes.append("buf is not installed (pip install buf-bin).")
    timings = [_timing(lab, name, command) for name, command in commands.items()]
    rows = [[timing.command, f"{timing.shortest:.2f}", f"{timing.median:.2f}"] for timing in timings]
    return SectionResult(
        tables=[Table("Linting the table", ("", "shortest, s", "median, s"), [Group("", rows)], notes)],
        data={"timings": [asdict(timing) for timing in timings]},
    )


def _buf() -> str | None:
    """Return the buf of this environment, or else the one on the PATH."""
    return shutil.which("buf", path=str(Path(sys.executable).parent)) or shutil.which("buf")


def _timing(lab: Lab, name: str, command: Sequence[str]) -> Timing:
    seconds = sorted(_seconds(command) for _ in range(QUICK_RUNS if lab.quick else RUNS))
    timing = Timing(name, seconds[0], statistics.median(seconds))
    lab.say(f"linting {name}: {timing.median:.2f} s")
    return timing


def _seconds(command: Sequence[str]) -> float:
    start = time.perf_counter()
    done = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603  # ours, and buf
    if done.returncode not in _FINDINGS:
        raise BenchError(f"{' '.join(command)} found nothing or could not run:\n{done.stdout}{done.stderr}")
    return time.perf_counter() - start
