"""What make says before it installs."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

_ROOT = Path(__file__).parents[1]


_PACKAGES = {
    "ready-standard": [".[standard]"],
    "ready-demo": [".[standard]", "./rover[detect,video]"],
    "ready-dev": [".[dev]", "./rover[vision]", "./check_launch"],
    "ready-docs": [".[docs]", "./rover", "./check_launch"],
    "ready-fuzz": [".[fuzz]"],
    "ready-bench": [".[bench]", "./rover"],
    "ready-bench-vision": [".[bench]", "./rover[detect]"],
    "ready-bench-video": [".[bench]", "./rover[video]"],
}


@pytest.mark.parametrize(("environment", "packages"), _PACKAGES.items())
def test_make_says_what_it_installs_where_and_how_much(environment: str, packages: list[str], tmp_path: Path) -> None:
    """The line comes before pip starts, whose own progress is shown; an environment is made once."""
    target = f"{tmp_path}/{environment}"
    announcement, *rest = _made(tmp_path, target)
    assert announcement.startswith(f"installing in {tmp_path}: about ")
    editable = " ".join(f"--editable {one}" for one in packages)
    assert rest == [f"ran: -m pip install --disable-pip-version-check {editable}"]
    assert _made(tmp_path, target) == [f"make: '{target}' is up to date."]


def test_the_environment_with_all_packages_serves_other_targets(tmp_path: Path) -> None:
    """It is brought up to date for them, and nothing is installed beside it."""
    _made(tmp_path, f"{tmp_path}/ready-full")
    assert not [line for line in _made(tmp_path, "--dry-run", "test", "docs") if "pip install" in line]


def _made(environment: Path, *words: str) -> list[str]:
    """What make prints, with an environment whose Python does nothing."""
    python = environment / "bin" / "python"
    python.parent.mkdir(exist_ok=True)
    python.write_text('#!/bin/sh\necho "ran: $*"\n')
    python.chmod(0o755)
    # `make test OPENCV=4.8` hands its options and variables down in the environment.
    handed_down = {"MAKEFLAGS", "MAKELEVEL", "MAKEOVERRIDES", "MFLAGS", "OPENCV"}
    alone = {name: value for name, value in os.environ.items() if name not in handed_down}
    command = ["make", f"VENV={environment}", *words]
    return subprocess.run(command, cwd=_ROOT, env=alone, check=True, capture_output=True, text=True).stdout.splitlines()
