"""Places and comments of declarations, from the `SourceCodeInfo` in protoc's descriptors.

A location's path consists of field numbers of descriptor.proto and indices (`SourceCodeInfo.Location`): ``4, 0, 2, 1``
is the second field (2, 1) of the first message (4, 0).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from google.protobuf.descriptor_pb2 import DescriptorProto, EnumDescriptorProto, FileDescriptorProto

from roverlink.generator.diagnostics import Span, shown
from roverlink.generator.source_files import visible

Path = tuple[int, ...]

_FIELD_PARTS = {
    "name": (1,),
    "number": (3,),
    "label": (4,),
    "type": (5,),
    "type_name": (6,),
    "default": (7,),
    "options": (8,),
}
_TYPE_PARTS = {"name": (1,)}
_VALUE_PARTS = {"name": (1,), "number": (2,)}
_MESSAGE_RESERVED, _ENUM_RESERVED = 9, 4


class Places:
    """The places (line and column) and comments of the declarations in one .proto file."""

    def __init__(self, file: FileDescriptorProto, shown_root: str) -> None:
        self._shown = shown(shown_root, file.name)
        # Several locations may have one path: the first one is the whole declaration, the others are parts.
        locations = reversed(file.source_code_info.location)
        self._locations = {tuple(location.path): location for location in locations}

    def span(self, path: Path) -> Span:
        """Return the place of the declaration at a path; the whole file if the place is unknown."""
        location = self._locations.get(path)
        # SourceCodeInfo counts lines and columns from 0 (descriptor.proto, `span`); editors count from 1.
        return Span(self._shown, location.span[0] + 1, location.span[1] + 1) if location else Span(self._shown)

    def comment(self, path: Path) -> str:
        """Return the comment before the declaration at a path, or else the comment after it; empty without one."""
        location = self._locations.get(path)
        return (_clean(location.leading_comments) or _clean(location.trailing_comments)) if location else ""

    def of_field(self, path: Path) -> dict[str, Span]:
        """Return the places of a field's parts, by name: ``name``, ``number``, ``type``..."""
        return self._parts(path, _FIELD_PARTS)

    def of_message(self, path: Path, message: DescriptorProto) -> dict[str, Span]:
        """Return the places of a message's name and of its reserved ranges, by name."""
        ranges = [(reserved.start, reserved.end - 1) for reserved in message.reserved_range]
        return self._parts(path, _TYPE_PARTS) | self._reserved((*path, _MESSAGE_RESERVED), ranges)

    def of_enum(self, path: Path, enum: EnumDescriptorProto) -> dict[str, Span]:
        """Return the places of an enum's name and of its reserved ranges, by name."""
        ranges = [
            (reserved.start, reserved.end) for reserved in enum.reserved_range
        ]  # EnumReservedRange includes its end
        return self._parts(path, _TYPE_PARTS) | self._reserved((*path, _ENUM_RESERVED), ranges)

    def of_value(self, path: Path) -> dict[str, Span]:
        """Return the places of an enum value's parts, by name."""
        return self._parts(path, _VALUE_PARTS)

    def _parts(self, path: Path, parts: Mapping[str, Path]) -> dict[str, Span]:
        known = {name: (*path, *part) for name, part in parts.items()}
        return {name: self.span(part) for name, part in known.items() if part in self._locations}

    def _reserved(self, path: Path, ranges: Sequence[tuple[int, int]]) -> dict[str, Span]:
        return {f"reserved {first} to {last}": self.span((*path, index)) for index, (first, last) in enumerate(ranges)}


def _clean(comment: str | bytes) -> str:
    """Return a comment's text without the space after the slashes, and without white space at both ends.

    Characters that a terminal would obey are escaped, because generated files show the comment.
    """
    # protoc accepts comments in any encoding. A text that is not UTF-8 comes out of the descriptor as bytes.
    comment = comment.decode("utf-8", errors="replace") if isinstance(comment, bytes) else comment
    # protoc removes the `//`, but keeps the space after it (descriptor.proto, `leading_comments`).
    lines = [line.removeprefix(" ").rstrip() for line in comment.splitlines()]
    return visible("\n".join(lines).strip())
