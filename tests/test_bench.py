"""The bench ends with a whole report, with the compilers of its C++ programs and without them."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from needs import NO_AV, NO_OPENCV

ROOT = Path(__file__).parents[1]
SECTIONS = {
    "bridging",
    "starting",
    "rover",
    "watching",
    "conversion",
    "signing",
    "lines",
    "generation",
    "linting",
    "history",
}


def _contestants(tmp_path: Path, programs: str) -> set[tuple[str, str]]:
    """The setting and the contestant of every point of a whole, short bench."""
    result = tmp_path / "result.json"
    options = ("--quick", "--seconds", "0.1", "--json", str(result), "--out", str(tmp_path / "out"))
    done = subprocess.run(
        [sys.executable, "-m", "bench", *options],
        cwd=ROOT,
        env={**os.environ, "PATH": programs},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    report: dict[str, Any] = json.loads(result.read_text())
    assert report["sections"].keys() == SECTIONS
    return {(point["setting"], point["contestant"]) for point in report["sections"]["bridging"]["points"]}


@pytest.mark.exhaustive
def test_the_bench_measures_every_section_without_compilers(tmp_path: Path) -> None:
    """Load and observers are then in Python."""
    programs = tmp_path / "bin"
    programs.mkdir()
    (programs / "git").symlink_to(str(shutil.which("git")))
    assert {("full", "roverlink"), ("outbound", "roverlink")} <= _contestants(tmp_path, str(programs))


@pytest.mark.exhaustive
@pytest.mark.skipif(not shutil.which("idlc"), reason="cyclonedds-tools is not installed")
def test_the_bench_measures_every_section_with_compilers(tmp_path: Path) -> None:
    """The bridge in C++ takes part too."""
    assert {("full", "cpp"), ("outbound", "cpp")} <= _contestants(tmp_path, os.environ["PATH"])


@pytest.mark.exhaustive
def test_three_streams_need_no_more_memory_over_time(tmp_path: Path) -> None:
    """And the latency does not grow; `make bench-video` looks at it for ten minutes."""
    pytest.importorskip("cv2", reason=NO_OPENCV)
    pytest.importorskip("av", reason=NO_AV)
    result = tmp_path / "result.json"
    options = ("--only", "long", "--long", "60", "--json", str(result))
    done = subprocess.run(
        [sys.executable, "-m", "rover.bench.video", *options], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    medians = json.loads(result.read_text())["sections"]["long"]["medians_of_second_and_last_quarter"]
    for name, (early, late) in medians.items():
        # a busy computer has no steady latency
        assert late - early < (500 if name.endswith("ms") else 8), name
