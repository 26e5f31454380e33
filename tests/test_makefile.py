"""What make says before it installs."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

_ROOT = Path(__file__).parents[1]


_PACKAGES = {
    "ready": [".[standard]"],
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
    python = tmp_path / "bin" / "python"
    python.parent.mkdir()
    python.write_text('#!/bin/sh\necho "ran: $*"\n')
    python.chmod(0o755)
    command = ["make", f"VENV={tmp_path}", f"{tmp_path}/{environment}"]
    # `make test` hands its own options down in the environment; with them, make names each folder that it enters.
    alone = {name: value for name, value in os.environ.items() if name not in {"MAKEFLAGS", "MAKELEVEL", "MFLAGS"}}

    def said() -> list[str]:
        made = subprocess.run(command, cwd=_ROOT, env=alone, check=True, capture_output=True, text=True)
        return made.stdout.splitlines()

    announcement, *rest = said()
    assert announcement.startswith(f"installing in {tmp_path}: about ")
    assert rest == [
        f"ran: -m pip install --disable-pip-version-check {' '.join(f'--editable {one}' for one in packages)}"
    ]
    assert said() == [f"make: '{tmp_path}/{environment}' is up to date."]
