"""Conversion of message classes to ROS 2 message definitions (MCAP's encoding ``ros2msg``), and back.

A definition is the text of a .msg file. The definitions of all messages inside it follow, each after a line of ``=``
and a line ``MSG: package/Name``. The generated code is not needed to read a recording, because the recording contains
all definitions.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator
from typing import Annotated, Any

from roverlink.runtime.core.cdr import type_name
from roverlink.runtime.core.errors import SetupError
from roverlink.runtime.core.messages import (
    PRIMITIVES,
    Bound,
    Length,
    Message,
    UInt8,
    default_of,
    fields_of,
    messages_in,
    type_of,
)

_SEPARATOR = "=" * 80
_FIELD = re.compile(
    r"(?P<base>[\w/]+)(<=(?P<characters>\d+))?(?P<list>\[(?P<most><=)?(?P<count>\d*)\])?\s+(?P<name>\w+)\s*(?P<rest>.*)"
)


# --- writing ----------------------------------------------------------------------------------------------------


def definition_of(message_type: type[Message]) -> str:
    """Return the definition of a message class, followed by the definitions of all messages inside it."""
    parts = [_fields_text(message_type)]
    for nested in messages_in(message_type):
        parts += [_SEPARATOR, f"MSG: {_short(nested.__msgtype__)}", _fields_text(nested)]
    return "\n".join(parts)


def _fields_text(message_type: type[Message]) -> str:
    # Constants are left out: they do not change how a message is read.
    return "\n".join(f"{_short(type_name(field.type))} {field.name}" for field in fields_of(message_type))


def _short(type_name: str) -> str:
    """Return ``comms/msg/SensorState[3]`` as ``comms/SensorState[3]``, the form that all MCAP readers accept."""
    return type_name.replace("/msg/", "/")


# --- reading ----------------------------------------------------------------------------------------------------


def message_type_from(name: str, definition: str) -> type[Message]:
    """Make a message class from its definition, such as one in a recording; ``name`` is the message's full name.

    Raises `SetupError` if the definition uses a message that it does not contain, or a wide string.
    """
    first, *others = re.split(r"^=+\n", definition, flags=re.MULTILINE)
    texts = {_short(name): first}
    for other in others:
        title, _, text = other.partition("\n")
        texts[_short(title.removeprefix("MSG:").strip())] = text
    return _Reader(texts).message_type(_short(name))


class _Reader:
    """Reader that makes message classes from a definition, one class for each message in it."""

    def __init__(self, texts: dict[str, str]) -> None:
        self._texts = texts
        self._made: dict[str, type[Message]] = {}

    def message_type(self, name: str) -> type[Message]:
        if name not in self._made:
            if name not in self._texts:
                raise SetupError(f"the recorded definition uses {name} but does not define it")
            package, _, short = name.rpartition("/")
            fields = [field for line in self._texts[name].splitlines() for field in self._fields(line, package)]
            namespace = {"__msgtype__": f"{package}/msg/{short}"}
            self._made[name] = dataclasses.make_dataclass(short, fields, bases=(Message,), namespace=namespace)
        return self._made[name]

    def _fields(self, line: str, package: str) -> Iterator[tuple[str, Any, Any]]:
        found = _FIELD.fullmatch(line.partition("#")[0].strip())
        if found is None or found["rest"].startswith("="):  # an empty line, a comment, or a constant
            return
        annotation = self._annotation(found, package)
        yield found["name"], annotation, dataclasses.field(default_factory=default_of(type_of(annotation)))

    def _annotation(self, found: re.Match[str], package: str) -> Any:
        element = self._element(found["base"], found["characters"], package)
        if found["list"] is None:
            return element
        container: Any = bytes if element is UInt8 else list.__class_getitem__(element)
        if not found["count"]:
            return container
        count = int(found["count"])
        return Annotated[container, Bound(count) if found["most"] else Length(count)]

    def _element(self, base: str, characters: str | None, package: str) -> Any:
        if base == "string":
            return Annotated[str, Bound(int(characters))] if characters else str
        if base in PRIMITIVES:
            return PRIMITIVES[base]
        if base == "wstring":
            raise SetupError("the message definition has a wide string (wstring), which is not supported")
        return self.message_type(_short(base) if "/" in base else f"{package}/{base}")
