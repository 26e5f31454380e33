"""Where things stand in a .proto file, and their comments, as protoc keeps them beside its descriptors.

protoc has a path for each part of a file: field numbers of descriptor.proto, and indices (`SourceCodeInfo.Location`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from google.protobuf.descriptor_pb2 import DescriptorProto, EnumDescriptorProto, FileDescriptorProto

from generator.declarations.comments import clean
from generator.diagnostics import Span, shown

Path = tuple[int, ...]

_FIELD_PARTS = {
    "name": (1,),
    "number": (3,),
    "label": (4,),
    "type": (5,),
    "type_name": (6,),
    "default": (7,),
    "options": (8,),
    "ctype": (8, 1),
    "jstype": (8, 6),
    "features": (8, 21),
    "utf8_validation": (8, 21, 4),
    "cpp_string_type": (8, 21, 1000, 2),
    "java_utf8_validation": (8, 21, 1001, 2),
    "json_name": (10,),
}
_MESSAGE_PARTS = {"name": (1,), "no_standard_descriptor_accessor": (7, 2), "json_format": (7, 12, 6)}
_ENUM_PARTS = {"name": (1,), "enum_type": (3, 7, 2), "json_format": (3, 7, 6)}
_VALUE_PARTS = {"name": (1,), "number": (2,)}
_MESSAGE_ONEOF, _MESSAGE_RESERVED, _MESSAGE_RESERVED_NAME = 8, 9, 10
_ENUM_RESERVED, _ENUM_RESERVED_NAME = 4, 5
_FILE_JAVA_CHECKS_UTF8 = (8, 27)


class Places:
    """The places of one file."""

    def __init__(self, file: FileDescriptorProto, shown_root: str) -> None:
        self._shown = shown(shown_root, file.name)
        # Where several have one path, the first is the whole, and the others are parts of it.
        locations = reversed(file.source_code_info.location)
        self._locations = {tuple(location.path): location for location in locations}

    def span(self, path: Path) -> Span:
        """Where something stands; the file where that is not known."""
        location = self._locations.get(path)
        return Span(self._shown, location.span[0] + 1, location.span[1] + 1) if location else Span(self._shown)

    def comment(self, path: Path) -> str:
        """The comment before it, or else behind it."""
        location = self._locations.get(path)
        return (clean(location.leading_comments) or clean(location.trailing_comments)) if location else ""

    def of_field(self, path: Path) -> dict[str, Span]:
        """Parts of a field."""
        # What is said for the whole file is said for each of its fields.
        return self._parts(path, _FIELD_PARTS) | self._parts((), {"java_utf8_validation": _FILE_JAVA_CHECKS_UTF8})

    def of_message(self, path: Path, message: DescriptorProto) -> dict[str, Span]:
        """Parts of a message but for its fields."""
        oneofs = {f"oneof {one.name}": (*path, _MESSAGE_ONEOF, i) for i, one in enumerate(message.oneof_decl)}
        ranges = [(reserved.start, reserved.end - 1) for reserved in message.reserved_range]
        return (
            self._parts(path, _MESSAGE_PARTS)
            | {name: self.span(place) for name, place in oneofs.items()}
            | self._reserved((*path, _MESSAGE_RESERVED), ranges)
            | self._reserved((*path, _MESSAGE_RESERVED_NAME), message.reserved_name)
        )

    def of_enum(self, path: Path, enum: EnumDescriptorProto) -> dict[str, Span]:
        """Parts of an enum but for its values."""
        ranges = [(reserved.start, reserved.end) for reserved in enum.reserved_range]  # here, both ends are included
        return (
            self._parts(path, _ENUM_PARTS)
            | self._reserved((*path, _ENUM_RESERVED), ranges)
            | self._reserved((*path, _ENUM_RESERVED_NAME), enum.reserved_name)
        )

    def of_value(self, path: Path) -> dict[str, Span]:
        """Parts of an enum's value."""
        return self._parts(path, _VALUE_PARTS)

    def _parts(self, path: Path, parts: Mapping[str, Path]) -> dict[str, Span]:
        known = {name: (*path, *part) for name, part in parts.items()}
        return {name: self.span(part) for name, part in known.items() if part in self._locations}

    def _reserved(self, path: Path, reserved: Sequence[tuple[int, int]] | Sequence[str]) -> dict[str, Span]:
        names = [one if isinstance(one, str) else f"{one[0]} to {one[1]}" for one in reserved]
        return {f"reserved {name}": self.span((*path, index)) for index, name in enumerate(names)}
