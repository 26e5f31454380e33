"""Parameters of a program's node, which ROS 2 can read and change while the program runs."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Mapping
from typing import Any, Generic, TypeVar

from roverkit.node.ros_connection import USE_SIM_TIME, uses_simulated_time

from roverlink.runtime.core.errors import SetupError, nearest
from roverlink.runtime.interfaces.rcl_interfaces import ParameterDescriptor, ParameterValue
from roverlink.runtime.ros_arguments.ros_args import RosArguments

T = TypeVar("T")

_SIM_TIME = (ParameterValue.BOOL, "true if the time is that of a simulation, on /clock")
_READ_ONLY = frozenset({USE_SIM_TIME})
_UNUSED = frozenset({"start_type_description_service"})
"""Parameters that rclpy declares for every node, so that `ros2 param dump` writes them; this node does not use them."""
_TYPES = {
    ParameterValue.STRING: (str, "a text (in quotes if it looks like a number)"),
    ParameterValue.DOUBLE: (float, "a number, such as 0.15"),
    ParameterValue.INTEGER: (int, "a whole number, such as 4500"),
    ParameterValue.BOOL: (bool, "true or false"),
}


class DeclaredParameters(Generic[T]):
    """Parameters of one node, which ROS 2 tools can read and change. Safe to use from several threads.

    The options of the command line are their first values, unless the arguments after ``--ros-args`` set them. The
    parameter ``use_sim_time`` is one of them, and cannot change.
    """

    def __init__(
        self,
        descriptions: Mapping[str, tuple[int, str]],
        options: Mapping[str, Any],
        ros: RosArguments,
        read: Callable[[Mapping[str, Any]], T],
        logger: logging.Logger,
    ) -> None:
        """Read the first values.

        ``descriptions`` has the type (of `ParameterValue`) and the description of each parameter. ``read`` returns what
        the values mean, and raises `SetupError` if one of them is wrong.
        """
        self._descriptions = {**descriptions, USE_SIM_TIME: _SIM_TIME}
        self._read, self._logger, self._lock = read, logger, threading.Lock()
        self.descriptors: Mapping[str, ParameterDescriptor] = {
            name: ParameterDescriptor(name, type_, description, read_only=name in _READ_ONLY)
            for name, (type_, description) in self._descriptions.items()
        }
        """Declaration of each parameter by its name."""
        first = {**options, USE_SIM_TIME: uses_simulated_time(ros)}
        self._values: Mapping[str, Any] = self._completed(first, self._checked(ros.parameters))
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
            for name in _READ_ONLY & changes.keys():
                if changes[name] != before[name]:
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
            if name not in self._descriptions:
                raise SetupError(f"unknown parameter {name!r}; {nearest(name, self._descriptions)}")
            wanted, described = _TYPES[self._descriptions[name][0]]
            # YAML has no other way to tell 1 from 1.0
            checked[name] = float(value) if wanted is float and type(value) is int else value
            if type(checked[name]) is not wanted:
                raise SetupError(f"the parameter {name!r} is {value!r}; it must be {described}")
        return checked


class DefaultedParameters(DeclaredParameters[T]):
    """Parameters of a node whose command has no options for them: each has a default value."""

    def __init__(
        self,
        table: Mapping[str, tuple[Any, int, str]],
        ros: RosArguments,
        read: Callable[[Mapping[str, Any]], T],
        logger: logging.Logger,
    ) -> None:
        """Read the first values; ``table`` has the default, the type and the description of each parameter."""
        super().__init__(
            {name: (type_, description) for name, (_, type_, description) in table.items()},
            {name: default for name, (default, _, _) in table.items()},
            ros,
            read,
            logger,
        )
