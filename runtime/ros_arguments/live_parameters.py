"""Parameters of a running node: ROS 2 tools can read them, and change those that are not read-only.

If a tool changes several parameters at once, either all changes are applied or none. The middlewares offer the
parameters to ROS 2 through the interface `NodeParameters`.
"""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Mapping
from typing import Any

from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.core.registry import Registry
from roverlink.runtime.interfaces.rcl_interfaces import IntegerRange, ParameterDescriptor, ParameterValue
from roverlink.runtime.ros_arguments import parameters
from roverlink.runtime.ros_arguments.parameters import Declaration, Parameters


class LiveParameters:
    """Parameters of one node. Safe to use from several threads."""

    def __init__(self, registry: Registry, initial: Parameters, logger: logging.Logger) -> None:
        self._registry, self._current, self._logger = registry, initial, logger
        self.declared: Mapping[str, Declaration] = parameters.declarations(registry)
        """Declaration of each parameter by its name."""
        self.descriptors: Mapping[str, ParameterDescriptor] = {
            name: _descriptor(name, declaration) for name, declaration in self.declared.items()
        }
        """The same as ROS 2 messages."""
        self._lock = threading.Lock()
        self._apply: Callable[[Parameters], None] = _refuse_at_start

    @property
    def values(self) -> Mapping[str, Any]:
        """Value of each parameter by its name."""
        return self._current.values

    def on_change(self, apply: Callable[[Parameters], None]) -> None:
        """Set the function that applies changed parameters. Before this, every change is refused.

        ``apply`` gets all parameters with their new values; it must raise `SetupError` if it cannot apply them.
        """
        self._apply = apply

    def change(self, changes: Mapping[str, Any]) -> None:
        """Change parameters to the values in ``changes``, and apply them.

        Raises `SetupError` with the reason if one of them cannot change; then none has changed.
        """
        with self._lock:
            before, after = self._current, parameters.changed(self._registry, self._current, changes)
            self._apply(after)
            self._current = after
        for name, value in after.values.items():
            if value != before.values[name]:
                self._logger.info("parameter %s is now %s (it was %s)", name, value, before.values[name])


def _refuse_at_start(_: Parameters) -> None:
    raise SetupError("the node is starting; try again")


_TYPES = {int: ParameterValue.INTEGER, str: ParameterValue.STRING, bool: ParameterValue.BOOL}


def _descriptor(name: str, declared: Declaration) -> ParameterDescriptor:
    is_number = type(declared.default) is int
    return ParameterDescriptor(
        name,
        _TYPES[type(declared.default)],
        f"{declared.description}, in {declared.unit}" if declared.unit else declared.description,
        f"one of {', '.join(declared.choices)}" if declared.choices else "",
        read_only=declared.read_only,
        integer_range=[IntegerRange(declared.minimum, declared.maximum, 1)] if is_number else [],
    )
