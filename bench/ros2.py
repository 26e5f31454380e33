"""The ROS 2 from PyPI that `make test-ros2` installs in `.ros2/`, for the measurements of rclpy."""

import os
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

DISTRIBUTION = "jazzy"
_SCRIPT = Path(__file__).resolve().parents[1] / "tests" / "ros2" / "run.py"


def _harness() -> Any:
    """Return the script of `make test-ros2` as a module; it is no part of a package."""
    spec = spec_from_file_location("ros2_harness", _SCRIPT)
    if spec is None or spec.loader is None:
        raise ImportError(f"{_SCRIPT} cannot be loaded")
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


_HARNESS = _harness()
_FOLDER: Path = _HARNESS.ENVIRONMENTS / DISTRIBUTION


def is_ready() -> bool:
    """Return true if the distribution and the interface package are installed."""
    return (_FOLDER / "overlay" / "built").is_file()


def python() -> str:
    """Return the path of the distribution's Python."""
    return str(_FOLDER / "bin" / "python")


def environment() -> dict[str, str]:
    """Return the variables that differ in a shell in which the distribution is sourced, on this host alone."""
    variables: dict[str, str] = _HARNESS.environment(DISTRIBUTION)
    own = {name: value for name, value in variables.items() if os.environ.get(name) != value}
    return {**own, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
