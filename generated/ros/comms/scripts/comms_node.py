#!/usr/bin/env python3
# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Program for `ros2 run` and the launch file: starts the bridge, like `roverlink run`."""

import os
import sys
from pathlib import Path

PROJECT = Path("@PROJECT_FOLDER@")  # CMake replaces this by the folder of the project
ENVIRONMENT = PROJECT / ".venv"


def main() -> int:
    """Run the bridge with the given arguments. Returns 2 if roverlink cannot be imported."""
    try:
        from roverlink.__main__ import main as roverlink
    except ImportError as error:
        python = ENVIRONMENT / "bin" / "python"
        if python.exists() and Path(sys.prefix) != ENVIRONMENT:
            os.execv(python, [str(python), *sys.argv])  # noqa: S606  # no shell
        print(
            f"cannot import roverlink ({error}); Python:",
            sys.executable,
            file=sys.stderr,
        )
        print(
            "activate an environment that has it, or install its wheel in .venv of the project",
            file=sys.stderr,
        )
        return 2
    here = (PROJECT / "generated/registry.py").is_file()
    project = ["--project", str(PROJECT)] if here else []
    return roverlink(["run", *project, *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
