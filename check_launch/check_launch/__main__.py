"""Entry point of ``check-launch``: the command ``roverlink check-launch`` under a name of its own."""

import sys

from roverlink.__main__ import main as run_roverlink


def main() -> int:
    """Check launch files; return the exit code of ``roverlink check-launch``."""
    return run_roverlink(["check-launch", *sys.argv[1:]])


if __name__ == "__main__":
    raise SystemExit(main())
