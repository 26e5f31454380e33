"""An enum value has the name of a message.

In protobuf, enum values belong to the scope around the enum: `enum Kind { Motor = 0; }` declares `Kind` and `Motor`
(language guide, "Enum"). If a file of the same package declares a message `Motor`, the two files cannot be compiled
together. Often protoc reports this only when a third file imports both.

Bad::

    enum MessageType {
      SensorBoardIMUInfo = 0;
    }
    message SensorBoardIMUInfo {}

Good::

    enum MessageType {
      MESSAGE_TYPE_SENSOR_BOARD_IMU_INFO = 0;
    }
    message SensorBoardIMUInfo {}
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity, Span
from roverlink.generator.ir.ros_names import snake_case
from roverlink.generator.lint.context import Context
from roverlink.generator.protos.schema import ProtoEnum, ProtoMessage

RULE = Rule("NAM103", "enum-value-collides", __doc__)

_Messages = Mapping[str, tuple[str, ProtoMessage]]  # by full name, each with its file


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each enum with a value that has the name of a message in the same scope."""
    files = {**context.excluded_files, **context.files}
    messages = {found.full_name: (path, found) for path, file in files.items() for found in file.messages}
    for path, file in files.items():
        for enum in file.enums:
            yield from _check(path, enum, messages, context)


def _check(path: str, enum: ProtoEnum, messages: _Messages, context: Context) -> Iterator[Diagnostic]:
    scope = enum.full_name.removesuffix(enum.name)
    colliding = [value for value in enum.values if f"{scope}{value.name}" in messages]
    if not colliding:
        return
    first = colliding[0]
    file, message = messages[f"{scope}{first.name}"]
    named = [repr(value.name) for value in colliding[:3]] + ["..."] * (len(colliding) > 3)
    prefixed = f"{snake_case(enum.name)}_{snake_case(first.name)}".upper()
    finding = RULE.at(
        context.place(path, first.span.line, first.span.column),
        f"values of the enum {enum.name!r} have the names of messages: {', '.join(named)}",
        f"start the values with the enum's name, as in {prefixed}; or delete the enum if nothing uses it",
        [(_place(file, message, context), "the message is here")],
        type=enum.full_name,
        number=first.number,
    )
    # An excluded file is never compiled, so the collision does no harm yet.
    excluded = not {path, file}.isdisjoint(context.excluded_files)
    yield dataclasses.replace(finding, severity=Severity.WARNING) if excluded else finding


def _place(file: str, message: ProtoMessage, context: Context) -> Span:
    return context.place(file, message.span.line, message.span.column)
