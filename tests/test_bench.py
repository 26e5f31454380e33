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

ROOT = Path(__file__).parents[1]
SECTIONS = {"bridging", "watching", "conversion", "signing", "generation", "linting", "history"}


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


@pytest.mark.slow
def test_the_bench_measures_every_section_without_compilers(tmp_path: Path) -> None:
    """Load and observers are then in Python."""
    programs = tmp_path / "bin"
    programs.mkdir()
    (programs / "git").symlink_to(str(shutil.which("git")))
    assert {("full", "roverlink"), ("outbound", "roverlink")} <= _contestants(tmp_path, str(programs))


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which("idlc"), reason="cyclonedds-tools is not installed")
def test_the_bench_measures_every_section_with_compilers(tmp_path: Path) -> None:
    """The bridge in C++ takes part too."""
    assert {("full", "cpp"), ("outbound", "cpp")} <= _contestants(tmp_path, os.environ["PATH"])
