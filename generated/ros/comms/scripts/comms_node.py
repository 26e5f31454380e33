#!/usr/bin/env python3
# Generated from mapping.yaml; do not edit.
# Regenerate with: roverlink generate
"""Program for `ros2 run` and the launch files: starts the bridge, like `roverlink run`.

Beside it are the folders project, with the generated code, and runtime, with roverlink, if it was vendored.
"""

import sys
from pathlib import Path

# Not resolved: with --symlink-install, this file is a link.
FOLDER = Path(__file__).absolute().parent
PROTOBUF = "3.20"


def main() -> int:
    """Run the bridge with the given arguments. Returns 2 if a package that it needs is missing or too old."""
    sys.path.insert(0, str(FOLDER / "runtime"))
    try:
        import google.protobuf
        import yaml  # noqa: F401  # the bridge needs it, too
        from roverlink.__main__ import main as roverlink
    except ImportError as error:
        if error.name == "roverlink":
            cure = "activate an environment that has roverlink, or run `roverlink generate --vendor-runtime`"
        else:
            cure = "install python3-yaml, and `pip install 'protobuf>=3.20,<8'`"
        print(
            f"{sys.executable} cannot run the bridge ({error}): {cure}", file=sys.stderr
        )
        return 2
    version = google.protobuf.__version__
    if [int(part) for part in version.split(".")[:2]] < [
        int(part) for part in PROTOBUF.split(".")
    ]:
        print(
            f"protobuf {version} is too old: `pip install 'protobuf>=3.20,<8'`",
            file=sys.stderr,
        )
        return 2
    return roverlink(["run", "--project", str(FOLDER / "project"), *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
