"""Parameters of a program's node, which ROS 2 can read and change while the program runs."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Generic, TypeVar

from roverkit.node.ros_connection import uses_simulated_time

from roverlink.nodes import USE_SIM_TIME, Parameter
from roverlink.runtime.core.errors import SetupError, nearest
from roverlink.runtime.interfaces.rcl_interfaces import ParameterDescriptor, ParameterValue
from roverlink.runtime.ros_arguments.ros_args import RosArguments

T = TypeVar("T")

_UNUSED = frozenset({"start_type_description_service"})
"""Parameters that rclpy declares for every node, so that `ros2 param dump` writes them; this node does not use them."""
_TYPES = {
    str: (ParameterValue.STRING, "a text (in quotes if it looks like a number)"),
    float: (ParameterValue.DOUBLE, "a number, such as 0.15"),
    int: (ParameterValue.INTEGER, "a whole number, such as 4500"),
    bool: (ParameterValue.BOOL, "true or false"),
}


class DeclaredParameters(Generic[T]):
    """Parameters of one node, which ROS 2 tools can read and change. Safe to use from several threads.

    Their first values are the options of the command line, or else the declared defaults, unless the arguments after
    ``--ros-args`` set them. The parameter ``use_sim_time`` is one of them, and cannot change.
    """

    def __init__(
        self,
        declared: Sequence[Parameter],
        options: Mapping[str, Any],
        ros: RosArguments,
        read: Callable[[Mapping[str, Any]], T],
        logger: logging.Logger,
    ) -> None:
        """Read the first values.

        ``options`` has the values of the command line by the names of the parameters. ``read`` returns what the values
        mean, and raises `SetupError` if one of them is wrong.
        """
        self._declared = {one.name: one for one in (*declared, USE_SIM_TIME)}
        self._read, self._logger, self._lock = read, logger, threading.Lock()
        self.descriptors: Mapping[str, ParameterDescriptor] = {
            name: ParameterDescriptor(name, _TYPES[one.type][0], one.meaning, read_only=one.read_only)
            for name, one in self._declared.items()
        }
        """Declaration of each parameter by its name."""
        first = {name: one.default for name, one in self._declared.items()}
        first |= {**options, USE_SIM_TIME.name: uses_simulated_time(ros)}
        given = self._checked(ros.parameters_in(self._declared, logger))
        self._values: Mapping[str, Any] = self._completed(first, given)
        self._meaning = read(self._values)

    @property
    def values(self) -> Mapping[str, Any]:
        """Value of each parameter by its name."""
        return self._values

    @property
    def meaning(self) -> T:
        """Meaning of the values, as `read` returned it; another object after each change."""
        return self._meaning

    def change(self, changes: Mapping[str, Any]) -> None:
        """Change parameters, and read the files that they name again.

        Raises `SetupError` with the reason if one of them cannot change; then none has changed.
        """
        changes = self._checked(changes)
        with self._lock:
            before = self._values
            for name in changes:
                if self._declared[name].read_only and changes[name] != before[name]:
                    value = str(changes[name]).lower()
                    raise SetupError(f"the parameter {name!r} is read-only; restart the node with -p {name}:={value}")
            after = self._completed(before, changes)
            self._meaning, self._values = self._read(after), after
        for name in changes:
            self._logger.info("parameter %s is now %r (it was %r)", name, after[name], before[name])

    def _completed(self, before: Mapping[str, Any], changes: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return the values after changes; a subclass adds what else changes then."""
        return {**before, **changes}

    def _checked(self, given: Mapping[str, Any]) -> dict[str, Any]:
        """Return the values of the parameters that this node has.

        Raises `SetupError` for other names and other types.
        """
        checked = {}
        for name, value in given.items():
            if name in _UNUSED:
                continue
            if name not in self._declared:
                raise SetupError(f"unknown parameter {name!r}; {nearest(name, self._declared)}")
            wanted = self._declared[name].type
            # YAML has no other way to tell 1 from 1.0
            checked[name] = float(value) if wanted is float and type(value) is int else value
            if type(checked[name]) is not wanted:
                raise SetupError(f"the parameter {name!r} is {value!r}; it must be {_TYPES[wanted][1]}")
        return checked
