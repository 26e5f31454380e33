"""What make says before it installs."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

_ROOT = Path(__file__).parents[1]


_EXTRAS = {
    "ready": "standard",
    "ready-demo": "standard,detect,video",
    "ready-dev": "dev",
    "ready-docs": "docs",
    "ready-fuzz": "fuzz",
    "ready-bench": "bench",
    "ready-bench-vision": "detect,bench",
    "ready-bench-video": "video,bench",
}


@pytest.mark.parametrize(("environment", "extras"), _EXTRAS.items())
def test_make_says_what_it_installs_where_and_how_much(environment: str, extras: str, tmp_path: Path) -> None:
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
    assert announcement.startswith(f"installing roverlink with [{extras}] in {tmp_path}: about ")
    assert rest == [f"ran: -m pip install --disable-pip-version-check --editable .[{extras}]"]
    assert said() == [f"make: '{tmp_path}/{environment}' is up to date."]
