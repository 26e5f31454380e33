"""A .proto file, as far as it could be read.

Lines and columns count from 1, as protoc counts: in bytes, a tab to the next 8th.
"""

from __future__ import annotations

from dataclasses import dataclass

from roverlink.generator.protos.schema import ProtoEnum, ProtoExtension, ProtoMessage

LARGEST_FIELD_NUMBER = 2**29 - 1
"""What ``max`` is in a range of fields, but for `LARGEST_MESSAGE_SET_NUMBER`."""
LARGEST_MESSAGE_SET_NUMBER = 2**31 - 2
"""What ``max`` is in a message with the option ``message_set_wire_format``."""
LARGEST_ENUM_NUMBER = 2**31 - 1


@dataclass(frozen=True, slots=True, order=True)
class Problem:
    """Something that could not be read, and was skipped; or that was read although it is not right."""

    line: int
    column: int
    what: str


@dataclass(frozen=True, slots=True)
class Import:
    """A file that this one needs."""

    path: str
    kind: str
    """``public``, ``weak``, ``option``; or empty."""
    line: int
    column: int


@dataclass(frozen=True, slots=True)
class File:
    """All that could be read of a .proto file."""

    syntax: str
    """``proto2``, ``proto3``, or an edition, such as ``2023``; empty where the file does not say."""
    package: str
    imports: tuple[Import, ...]
    messages: tuple[ProtoMessage, ...]
    """All of them, each before those that stand in it. Types are as written, ``map<K, V>`` among them."""
    enums: tuple[ProtoEnum, ...]
    """All of them, those that stand in no message first."""
    extensions: tuple[ProtoExtension, ...]
    """All of them, those inside messages too; the messages that they extend are as written."""
    problems: tuple[Problem, ...]

    @property
    def broken(self) -> bool:
        """Whether anything was skipped: protoc refuses this file, and what is read of it may be less than was meant."""
        return bool(self.problems)

    @property
    def imported(self) -> tuple[str, ...]:
        """The files that have to be compiled with it; of those that it imports for their options, it has no types."""
        return tuple(one.path for one in self.imports if one.kind != "option")

    @property
    def outermost(self) -> tuple[ProtoMessage, ...]:
        """The messages that stand in no other."""
        return tuple(message for message in self.messages if message.full_name.rpartition(".")[0] == self.package)
