"""Fields of a standard message, found by their paths, with their units."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from roverlink.generator.diagnostics import Diagnostic, Span
from roverlink.generator.ir.interfaces import Interface, InterfaceType, Path
from roverlink.generator.resolve.interfaces import meanings
from roverlink.generator.resolve.standard.standard_rules import UnknownTargetField
from roverlink.suggestions import nearest


@dataclass(frozen=True, slots=True)
class Place:
    """Field of a standard message, with the path that leads to it."""

    path: Path
    type: InterfaceType
    holders: tuple[str, ...]
    """Full names of the messages along the path, the outermost first. The last one declares the field."""

    @property
    def dotted(self) -> str:
        """Path of the field with dots, as the table writes it."""
        return ".".join(self.path)

    @property
    def unit(self) -> str:
        """Unit of the field by the definition of its message; empty if the definition gives none."""
        return meanings.unit_of(self.holders, self.path)

    @property
    def shown(self) -> str:
        """Field and message as diagnostics show them: ``'angular_velocity.x' of sensor_msgs/Imu``."""
        return f"{self.dotted!r} of {short(self.holders[0])}"


def short(name: str) -> str:
    """Return a message's full name in the form of the table.

    >>> short("sensor_msgs/msg/Imu")
    'sensor_msgs/Imu'
    """
    return name.replace("/msg/", "/")


class Places:
    """Lookup of the fields of one standard message, and of the messages inside it, by their paths."""

    def __init__(
        self, root: Interface, definition: Callable[[str], Interface], report: Callable[[Diagnostic], None]
    ) -> None:
        self.root, self.definition, self._report = root, definition, report

    def find(self, path: Path, span: Span) -> Place | None:
        """Return the field of the message at a path; if there is no such field, report the path and return None."""
        interface, holders = self.root, [self.root.name]
        for depth, name in enumerate(path):
            field = next((field for field in interface.fields if field.name == name), None)
            if field is None:
                help = nearest(
                    name, known := [field.name for field in interface.fields], f"known fields: {', '.join(known)}"
                )
                message = f"{short(interface.name)} has no field {name!r}"
                self._report(UnknownTargetField.at(span, message, help))
                return None
            if depth == len(path) - 1:
                return Place(path, field.type, tuple(holders))
            if not field.type.is_message or field.type.is_many:
                message = f"'{'.'.join(path[: depth + 1])}' is a {field.type}, which has no fields"
                self._report(UnknownTargetField.at(span, message))
                return None
            interface = self.definition(field.type.name)
            holders.append(interface.name)
        return None
