"""The result of parsing a .proto file: its declarations and its problems.

Lines and columns count from 1. As in protoc, a column counts bytes, and a tab moves to the next multiple of 8.
"""

from __future__ import annotations

from dataclasses import dataclass

from roverlink.generator.protos.schema import ProtoEnum, ProtoExtension, ProtoMessage

"""The number that ``max`` means in a range of field numbers, for messages without ``message_set_wire_format``."""
LARGEST_MESSAGE_SET_NUMBER = 2**31 - 2
"""The number that ``max`` means in a range of field numbers, for messages with ``message_set_wire_format``."""
LARGEST_ENUM_NUMBER = 2**31 - 1


@dataclass(frozen=True, slots=True, order=True)
class Problem:
    """A place with wrong syntax. The parser skips the statement there, or reads it as far as possible."""

    line: int
    column: int
    what: str


@dataclass(frozen=True, slots=True)
class Import:
    """An import statement."""

    path: str
    kind: str
    """The word after ``import``: ``public``, ``weak`` or ``option``; empty if there is none."""
    line: int
    column: int


@dataclass(frozen=True, slots=True)
class File:
    """The declarations that could be read from a .proto file."""

    syntax: str
    """``proto2``, ``proto3``, or an edition such as ``2023``; empty if the file does not say."""
    package: str
    imports: tuple[Import, ...]
    messages: tuple[ProtoMessage, ...]
    """All messages; each one stands before the messages that it contains.

    The types of fields are as the file writes them, such as ``map<K, V>``.
    """
    enums: tuple[ProtoEnum, ...]
    """All enums, top-level ones first."""
    extensions: tuple[ProtoExtension, ...]
    """All extensions, also those inside messages. The extended message's name is as the file writes it."""
    problems: tuple[Problem, ...]

    @property
    def broken(self) -> bool:
        """True if the file has a problem. Then protoc rejects the file, and declarations may be missing here."""
        return bool(self.problems)

    @property
    def imported(self) -> tuple[str, ...]:
        """Paths of the imported files that protoc has to compile, too. Files of ``import option`` are left out."""
        return tuple(imported.path for imported in self.imports if imported.kind != "option")

    @property
    def outermost(self) -> tuple[ProtoMessage, ...]:
        """The top-level messages."""
        return tuple(message for message in self.messages if message.full_name.rpartition(".")[0] == self.package)
