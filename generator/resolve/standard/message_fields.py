"""The fields of a standard message as a mapping names them, and what their definitions say of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from roverlink.generator.diagnostics import Diagnostic, Span, nearest
from roverlink.generator.ir.interfaces import Interface, InterfaceType, Path
from roverlink.generator.resolve.interfaces import meanings
from roverlink.generator.resolve.standard.standard_rules import UNKNOWN_TARGET


@dataclass(frozen=True, slots=True)
class Place:
    """A field of a standard message."""

    path: Path
    type: InterfaceType
    holders: tuple[str, ...]
    """The messages along the path, the outermost first; the last one holds the field."""

    @property
    def dotted(self) -> str:
        """Its path as the table writes it."""
        return ".".join(self.path)

    @property
    def unit(self) -> str:
        """The unit that the definitions give it; empty where they give none."""
        return meanings.unit_of(self.holders, self.path)

    @property
    def shown(self) -> str:
        """How findings call it."""
        return f"{self.dotted} of {short(self.holders[0])}"


def short(name: str) -> str:
    """``sensor_msgs/msg/Imu`` as the table writes it.

    >>> short("sensor_msgs/msg/Imu")
    'sensor_msgs/Imu'
    """
    return name.replace("/msg/", "/")


class Places:
    """The fields of one standard message, and of those in it."""

    def __init__(
        self, root: Interface, definition: Callable[[str], Interface], report: Callable[[Diagnostic], None]
    ) -> None:
        self.root, self.definition, self._report = root, definition, report

    def find(self, path: Path, span: Span) -> Place | None:
        """The field at a path; None, with a finding at ``span``, where there is none."""
        interface, holders = self.root, [self.root.name]
        for depth, name in enumerate(path):
            field = next((field for field in interface.fields if field.name == name), None)
            if field is None:
                help = nearest(name, known := [field.name for field in interface.fields], f"it has {', '.join(known)}")
                message = f"{short(interface.name)} has no field {name!r}"
                self._report(UNKNOWN_TARGET.at(span, message, help))
                return None
            if depth == len(path) - 1:
                return Place(path, field.type, tuple(holders))
            if not field.type.is_message or field.type.is_many:
                message = f"{'.'.join(path[: depth + 1])} is a {field.type}, in which no field can be named"
                self._report(UNKNOWN_TARGET.at(span, message))
                return None
            interface = self.definition(field.type.name)
            holders.append(interface.name)
        return None
