"""Parameters of the tracker's node: which markers it looks for, and where the landmarks are."""

from __future__ import annotations

import argparse
import logging
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from roverlink.aruco.ros_connection import USE_SIM_TIME, uses_simulated_time
from roverlink.aruco.target_options import marker_side
from roverlink.runtime.core.errors import SetupError, nearest
from roverlink.runtime.interfaces.rcl_interfaces import ParameterDescriptor, ParameterValue
from roverlink.runtime.ros_arguments.ros_args import RosArguments
from roverlink.vision import Landmarks, MarkerSet, read_landmarks
from roverlink.vision.markers.boards import read_boards
from roverlink.vision.markers.marker_set import SIDE

_DESCRIPTIONS = {
    "dictionary": (ParameterValue.STRING, "OpenCV's name of the dictionary of the markers"),
    "side": (ParameterValue.DOUBLE, "side of a marker's black square in metres"),
    "sides": (ParameterValue.STRING, "other sides of single markers in metres, such as: 7=0.1, 8=0.2"),
    "landmarks": (ParameterValue.STRING, "YAML file with the poses of the landmarks on the field; empty for none"),
    USE_SIM_TIME: (ParameterValue.BOOL, "true if the time is that of a simulation, on /clock"),
}
_READ_ONLY = frozenset({USE_SIM_TIME})
_UNUSED = frozenset({"start_type_description_service"})
"""Parameters that rclpy declares for every node, so that `ros2 param dump` writes them; this node does not use them."""
_TYPES = {
    ParameterValue.STRING: (str, "a text (in quotes if it looks like a number)"),
    ParameterValue.DOUBLE: (float, "a number, such as 0.15"),
    ParameterValue.BOOL: (bool, "true or false"),
}


@dataclass(frozen=True, slots=True, eq=False)
class Targets:
    """Markers for which a tracker looks, and the landmarks among them, if their poses are known."""

    markers: MarkerSet
    landmarks: Landmarks | None


class TargetParameters:
    """Parameters of one node, which ROS 2 tools can read and change. Safe to use from several threads.

    The options of the command line are their first values, unless the arguments after ``--ros-args`` set them.
    """

    descriptors: Mapping[str, ParameterDescriptor] = {
        name: ParameterDescriptor(name, type_, description, read_only=name in _READ_ONLY)
        for name, (type_, description) in _DESCRIPTIONS.items()
    }
    """Declaration of each parameter by its name."""

    def __init__(self, arguments: argparse.Namespace, ros: RosArguments, logger: logging.Logger) -> None:
        """Read the first values, and the files that they name. Raises `SetupError` if a file or a value is wrong."""
        self._lock, self._logger = threading.Lock(), logger
        self._boards = read_boards(arguments.boards) if arguments.boards else ()
        sides = dict(arguments.side)
        options = {
            "dictionary": arguments.dictionary,
            "side": sides.pop(None, SIDE),
            "sides": ", ".join(f"{number}={side}" for number, side in sides.items()),
            "landmarks": str(arguments.landmarks or ""),
            USE_SIM_TIME: uses_simulated_time(ros),
        }
        self._values: Mapping[str, Any] = {**options, **_checked(ros.parameters)}
        self._targets = self._read(self._values)

    @property
    def values(self) -> Mapping[str, Any]:
        """Value of each parameter by its name."""
        return self._values

    @property
    def targets(self) -> Targets:
        """Markers and landmarks for which the tracker looks; another object after each change."""
        return self._targets

    def change(self, changes: Mapping[str, Any]) -> None:
        """Change parameters, and read the files that they name again.

        Raises `SetupError` with the reason if one of them cannot change; then none has changed.
        """
        changes = _checked(changes)
        with self._lock:
            before = self._values
            for name in _READ_ONLY & changes.keys():
                if changes[name] != before[name]:
                    value = str(changes[name]).lower()
                    raise SetupError(f"the parameter {name!r} is read-only; restart the node with -p {name}:={value}")
            after = {**before, **changes}
            self._targets, self._values = self._read(after), after
        for name in changes:
            self._logger.info("parameter %s is now %r (it was %r)", name, after[name], before[name])

    def _read(self, values: Mapping[str, Any]) -> Targets:
        """Return what the parameters describe. Raises `SetupError` if a file or a value is wrong."""
        markers = MarkerSet(values["dictionary"], values["side"], _sides(values["sides"]), self._boards)
        landmarks = read_landmarks(Path(values["landmarks"])) if values["landmarks"] else None
        for target in landmarks.places if landmarks else ():
            if not markers.is_target(target):
                known = (
                    "a known board; define it in the file of --boards"
                    if isinstance(target, str)
                    else f"a known single marker; it is on a board, or {markers.dictionary} does not contain it"
                )
                raise SetupError(f"{values['landmarks']}: landmark {target!r} is not {known}")
        return Targets(markers, landmarks)


def _checked(given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of the parameters that this node has. Raises `SetupError` for other names and other types."""
    checked = {}
    for name, value in given.items():
        if name in _UNUSED:
            continue
        if name not in _DESCRIPTIONS:
            raise SetupError(f"unknown parameter {name!r}; {nearest(name, _DESCRIPTIONS)}")
        wanted, described = _TYPES[_DESCRIPTIONS[name][0]]
        # YAML has no other way to tell 1 from 1.0
        checked[name] = float(value) if wanted is float and type(value) is int else value
        if type(checked[name]) is not wanted:
            raise SetupError(f"the parameter {name!r} is {value!r}; it must be {described}")
    return checked


def _sides(text: str) -> dict[int, float]:
    """Parse the sides of single markers, such as ``7=0.1, 8=0.2``, in metres."""
    sides = {}
    for part in text.split(",") if text.strip() else ():
        try:
            number, side = marker_side(part.strip())
        except argparse.ArgumentTypeError as error:
            raise SetupError(f"the parameter 'sides': {error}") from error
        if number is None:
            raise SetupError(f"the parameter 'sides': {part.strip()!r} names no marker; write 7=0.1, or use 'side'")
        sides[number] = side
    return sides
