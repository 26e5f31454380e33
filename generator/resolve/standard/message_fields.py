"""Fields of a standard message by path, with their units."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from roverlink.generator.diagnostics import Diagnostic, Span, nearest
from roverlink.generator.ir.interfaces import Interface, InterfaceType, Path
from roverlink.generator.resolve.interfaces import meanings
from roverlink.generator.resolve.standard.standard_rules import UNKNOWN_TARGET


@dataclass(frozen=True, slots=True)
class Place:
    """Field of a standard message."""

    path: Path
    type: InterfaceType
    holders: tuple[str, ...]
    """Messages along the path, the outermost first; the last one has the field."""

    @property
    def dotted(self) -> str:
        """Path with dots, as the table writes it."""
        return ".".join(self.path)

    @property
    def unit(self) -> str:
        """Unit from the definitions; empty if they give none."""
        return meanings.unit_of(self.holders, self.path)

    @property
    def shown(self) -> str:
        """Name of the field in diagnostics."""
        return f"{self.dotted!r} of {short(self.holders[0])}"


def short(name: str) -> str:
    """Return a message's name as the table writes it.

    >>> short("sensor_msgs/msg/Imu")
    'sensor_msgs/Imu'
    """
    return name.replace("/msg/", "/")


class Places:
    """Fields of one standard message, and of its nested messages."""

    def __init__(
        self, root: Interface, definition: Callable[[str], Interface], report: Callable[[Diagnostic], None]
    ) -> None:
        self.root, self.definition, self._report = root, definition, report

    def find(self, path: Path, span: Span) -> Place | None:
        """Return the field at a path; report the path at ``span`` and return None if there is no such field."""
        interface, holders = self.root, [self.root.name]
        for depth, name in enumerate(path):
            field = next((field for field in interface.fields if field.name == name), None)
            if field is None:
                help = nearest(
                    name, known := [field.name for field in interface.fields], f"known fields: {', '.join(known)}"
                )
                message = f"{short(interface.name)} has no field {name!r}"
                self._report(UNKNOWN_TARGET.at(span, message, help))
                return None
            if depth == len(path) - 1:
                return Place(path, field.type, tuple(holders))
            if not field.type.is_message or field.type.is_many:
                message = f"'{'.'.join(path[: depth + 1])}' is a {field.type}, which has no fields"
                self._report(UNKNOWN_TARGET.at(span, message))
                return None
            interface = self.definition(field.type.name)
            holders.append(interface.name)
        return None
