#!/usr/bin/env python3
# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""What `ros2 run` and the launch file start: the bridge, as `roverlink run` does."""

import os
import sys
from pathlib import Path

PROJECT = Path("@PROJECT_FOLDER@")  # CMake fills in where the package was built
ENVIRONMENT = PROJECT / ".venv"


def main() -> int:
    """Run the bridge with the arguments that we have; 2 where roverlink is not here."""
    try:
        from roverlink.__main__ import main as roverlink
    except ImportError as error:
        python = ENVIRONMENT / "bin" / "python"
        if python.exists() and Path(sys.prefix) != ENVIRONMENT:
            os.execv(python, [str(python), *sys.argv])  # noqa: S606  # no shell
        print(f"roverlink does not import ({error}):", sys.executable, file=sys.stderr)
        print(
            "activate the environment that has it, or install it there", file=sys.stderr
        )
        return 2
    here = (PROJECT / "generated/registry.py").is_file()
    project = ["--project", str(PROJECT)] if here else []
    return roverlink(["run", *project, *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
