"""Definitions of ROS 2's standard messages, read from the file ``definitions.txt``."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

from roverlink.generator.ir.interfaces import Interface, InterfaceConstant, InterfaceField, InterfaceType

DISTRIBUTIONS = ("humble", "jazzy", "kilted", "lyrical")
"""ROS 2 distributions whose standard messages are known."""
FILE = Path(__file__).with_name("definitions.txt")

_TYPE = re.compile(r"(?P<name>[\w/]+)(<=(?P<text>\d+))?(\[((?P<length>\d+)|<=(?P<bound>\d+))?(?P<many>\]))?", re.ASCII)
_CONSTANT = re.compile(r"(?P<type>\w+) (?P<name>\w+)=(?P<value>.*)", re.ASCII)


class DistributionsDisagreeError(Exception):
    """Raised for a standard message that differs between distributions; the text names the difference."""


@cache
def _blocks() -> dict[str, tuple[str, tuple[str, ...]]]:
    """Return the marks and the lines of each message in ``definitions.txt``, by the message's full name.

    The marks name the distributions that have the message: ``@kilted @lyrical`` means that only these two have it. They
    are empty if all distributions have it. A line is a field or a constant, such as ``int32 sec``.
    """
    return {name: (marks, lines) for name, marks, lines in blocks(FILE.read_text(encoding="utf-8"))}


def blocks(text: str) -> Iterator[tuple[str, str, tuple[str, ...]]]:
    """Yield full name, marks and lines of each message in a text like ``definitions.txt``."""
    # A message starts in the first column, and its lines are indented.
    for block in re.split(r"^(?=\w)", text, flags=re.MULTILINE)[1:]:
        head, *lines = block.splitlines()
        name, _, marks = head.partition(" ")
        yield name, marks, tuple(line.strip() for line in lines)


def full_name(name: str) -> str:
    """Return the full name of a message from the table's name: ``sensor_msgs/msg/Imu`` for ``sensor_msgs/Imu``."""
    package, _, rest = name.partition("/")
    return f"{package}/{rest}" if rest.startswith("msg/") else f"{package}/msg/{rest}"


def names() -> list[str]:
    """Return the name of every message as the table writes it: ``sensor_msgs/Imu``."""
    return [name.replace("/msg/", "/") for name in _blocks()]


@cache
def interface(name: str, distribution: str) -> Interface | None:
    """Return the definition of a standard message by its full name; None if no distribution has the message.

    Raises `DistributionsDisagreeError` if ``distribution`` does not have the message. An empty ``distribution`` stands
    for all of them: the error is then raised if one of them does not have the message, or if their fields differ.
    Constants that not all of them have are left out.
    """
    if name not in _blocks():
        return None
    marks, lines = _blocks()[name]
    kept = [line.partition(" @")[0] for line in lines if _is_of(line, distribution)]
    if distribution:
        if marks and distribution not in marks:
            raise DistributionsDisagreeError(f"{name} does not exist in {distribution}, only in {_listed(marks)}")
    elif marks:
        raise DistributionsDisagreeError(f"{name} exists only in {_listed(marks)}")
    elif apart := [line for line in lines if " @" in line and "=" not in line]:
        field, _, of = apart[0].partition(" @")
        raise DistributionsDisagreeError(f"the field `{field}` of {name} exists only in {_listed('@' + of)}")
    return interface_of(name, kept)


def interface_of(name: str, lines: Iterable[str]) -> Interface:
    """Return the definition of a message from its lines without marks."""
    lines = list(lines)
    constants = tuple(_constant(match) for line in lines if (match := _CONSTANT.fullmatch(line)))
    return Interface(name, tuple(_field(line) for line in lines if "=" not in line.replace("<=", "")), constants)


def _is_of(line: str, distribution: str) -> bool:
    return " @" not in line or (bool(distribution) and f" @{distribution}" in line)


def _listed(marks: str) -> str:
    *others, last = (mark.removeprefix("@").capitalize() for mark in marks.split())
    return f"{', '.join(others)} and {last}" if others else last


def _field(line: str) -> InterfaceField:
    type, _, name = line.partition(" ")
    match = _TYPE.fullmatch(type)
    if match is None:
        raise AssertionError(f"{FILE.name} has {line!r}")
    length, bound, text = (int(part) if part else None for part in match.group("length", "bound", "text"))
    is_sequence = match["many"] is not None and length is None
    return InterfaceField(name, InterfaceType(match["name"], length, is_sequence, bound, text))


def _constant(match: re.Match[str]) -> InterfaceConstant:
    type, value = match["type"], match["value"]
    if type == "string":
        return InterfaceConstant(match["name"], type, value)
    if type == "bool":
        return InterfaceConstant(match["name"], type, value == "True")
    return InterfaceConstant(match["name"], type, float(value) if type.startswith("float") else int(value))
