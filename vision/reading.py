"""What the files that people write have in common: mappings, numbers, and poses.

A pose has a `position` in metres, and its turn as `rpy` or as `orientation`. `rpy` are degrees about the fixed x, y and
z axes, in that order (as in URDF); `orientation` is a quaternion x y z w.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from runtime.errors import SetupError, nearest
from vision.camera import Floats
from vision.pose import Pose, rotation_of

POSE = frozenset(("position", "rpy", "orientation"))
"""The keys of a pose."""
_UNIT = 0.01  # how far a quaternion's length may be from 1


def read_yaml(path: Path, what: str, known: set[str]) -> dict[str, Any]:
    """The mapping in a file of `what`. Raises `SetupError` for what is missing, is no YAML, or has other keys."""
    try:
        values = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise SetupError(f"cannot read the {what}: {error}") from error
    return mapping(values, str(path), known)


def pose(given: Mapping[str, Any], where: str) -> Pose:
    """The pose that a mapping has among its keys."""
    if "position" not in given:
        raise SetupError(f"{where} has no position")
    if ("rpy" in given) == ("orientation" in given):
        raise SetupError(f"{where} needs either rpy or orientation")
    rotation = (
        _of_rpy(numbers(given["rpy"], 3, f"{where}: rpy"))
        if "rpy" in given
        else _of_quaternion(numbers(given["orientation"], 4, f"{where}: orientation"), where)
    )
    return Pose(rotation, numbers(given["position"], 3, f"{where}: position"))


def mapping(value: object, where: str, known: set[str]) -> dict[str, Any]:
    """A mapping of known keys. Raises `SetupError` for anything else."""
    if not isinstance(value, dict):
        raise SetupError(f"{where} is no mapping")
    for key in value:
        if key not in known:
            raise SetupError(f"{where} has an unknown key {key!r}; {nearest(str(key), sorted(known))}")
    return value


def numbers(value: object, count: int, where: str) -> Floats:
    """A list of so many finite numbers. Raises `SetupError` for anything else."""
    found = value if isinstance(value, list) else []
    if len(found) != count or any(isinstance(one, bool) or not isinstance(one, int | float) for one in found):
        raise SetupError(f"{where} is {value!r}; it is a list of {count} numbers")
    if not all(math.isfinite(one) for one in found):
        raise SetupError(f"{where} is {value!r}; the numbers must be finite")
    return np.array(found, dtype=float)


def _of_rpy(degrees: Floats) -> Floats:
    roll, pitch, yaw = (rotation_of(np.radians(angle) * axis) for angle, axis in zip(degrees, np.eye(3)))
    rotation: Floats = yaw @ pitch @ roll
    return rotation


def _of_quaternion(quaternion: Floats, where: str) -> Floats:
    length = float(np.linalg.norm(quaternion))
    if abs(length - 1) > _UNIT:
        raise SetupError(f"{where}: the orientation's length is {length:.3g}; a quaternion x y z w has length 1")
    x, y, z, w = quaternion / length
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
