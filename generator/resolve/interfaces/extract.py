"""Script that writes ``definitions.txt``: ``python -m roverlink.generator.resolve.interfaces.extract``.

It reads the definitions from the rosbags package. The file is committed, so that `generate` and the generated code do
not need rosbags, whose import alone takes longer than compiling the table. A test compares the file with rosbags.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterable, Iterator
from typing import Any

from roverlink.generator.resolve.interfaces.definitions import DISTRIBUTIONS, FILE

_HEADER = """\
# The messages of ROS 2's common interfaces, from the definitions in the rosbags package.
# Made by: python -m roverlink.generator.resolve.interfaces.extract
# A line that ends with @ and the name of a distribution is for this distribution only.
"""
# rosidl adds this field to messages without fields, because C does not allow empty structs.
_PLACEHOLDER = "structure_needs_at_least_one_member"


def text() -> str:
    """Return the content of the file ``definitions.txt``."""
    stores = {name: _definitions(name) for name in DISTRIBUTIONS}
    names = sorted({name for store in stores.values() for name in store})
    return _HEADER + "\n".join(line for name in names for line in _lines(name, stores)) + "\n"


def _definitions(distribution: str) -> dict[str, Any]:
    definitions: dict[str, Any] = importlib.import_module(f"rosbags.typesys.stores.ros2_{distribution}").FIELDDEFS
    return {name: definition for name, definition in definitions.items() if name.split("/")[1] == "msg"}


def _lines(name: str, stores: dict[str, dict[str, Any]]) -> Iterator[str]:
    having = {distribution: store[name] for distribution, store in stores.items() if name in store}
    yield name + _mark([*having])
    parts = {distribution: [*_parts(*definition)] for distribution, definition in having.items()}
    for part in _merged(parts.values()):
        holders = [distribution for distribution, own in parts.items() if part in own]
        yield f"  {part}" + (_mark(holders) if len(holders) < len(parts) else "")


def _merged(all_parts: Iterable[list[str]]) -> list[str]:
    """Return the parts of a message in all distributions, in an order that keeps that of each distribution."""
    merged: list[str] = []
    for parts in all_parts:
        place = 0
        for part in parts:
            if part not in merged:
                merged.insert(place, part)
            place = merged.index(part) + 1
    return merged


def _mark(distributions: list[str]) -> str:
    return "" if len(distributions) == len(DISTRIBUTIONS) else "".join(f" @{name}" for name in distributions)


def _parts(constants: list[Any], fields: list[Any]) -> Iterator[str]:
    """Yield the constants and fields of a message, each as a .msg file writes it."""
    for name, type, value in constants:
        yield f"{type} {name}={value}"
    for name, definition in fields:
        if name != _PLACEHOLDER:
            yield f"{_type(definition)} {name}"


def _type(definition: Any) -> str:
    kind, detail = definition
    if kind.name == "NAME":
        return str(detail)
    if kind.name == "BASE":
        base, bound = detail
        return f"{base}<={bound}" if bound else str(base)
    element, count = _type(detail[0]), detail[1]
    if kind.name == "ARRAY":
        return f"{element}[{count}]"
    return f"{element}[<={count}]" if count else f"{element}[]"


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
