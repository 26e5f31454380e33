"""The definitions of the standard messages, as they stand in ``definitions.txt``."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

from roverlink.generator.ir.interfaces import Interface, InterfaceConstant, InterfaceField, InterfaceType

DISTRIBUTIONS = ("humble", "jazzy")
"""The distributions whose definitions are known."""
FILE = Path(__file__).with_name("definitions.txt")

_TYPE = re.compile(r"(?P<name>[\w/]+)(<=(?P<text>\d+))?(\[((?P<length>\d+)|<=(?P<bound>\d+))?(?P<many>\]))?", re.ASCII)
_CONSTANT = re.compile(r"(?P<type>\w+) (?P<name>\w+)=(?P<value>.*)", re.ASCII)


class DistributionsDisagreeError(Exception):
    """A message is not the same in every distribution; the message says in which fields."""


@cache
def _blocks() -> dict[str, tuple[str, tuple[str, ...]]]:
    """By full name: the marks behind it, and the lines below it."""
    blocks: dict[str, tuple[str, tuple[str, ...]]] = {}
    for block in re.split(r"\n(?=\w)", FILE.read_text(encoding="utf-8"))[1:]:
        head, *lines = block.splitlines()
        name, _, marks = head.partition(" ")
        blocks[name] = marks, tuple(line.strip() for line in lines)
    return blocks


def full_name(name: str) -> str:
    """``sensor_msgs/Imu`` as ``sensor_msgs/msg/Imu``."""
    package, _, rest = name.partition("/")
    return f"{package}/{rest}" if rest.startswith("msg/") else f"{package}/msg/{rest}"


def names() -> list[str]:
    """Every message, as the table writes it: ``sensor_msgs/Imu``."""
    return [name.replace("/msg/", "/") for name in _blocks()]


@cache
def interface(name: str, distribution: str) -> Interface | None:
    """The definition of a message by its full name; None where there is none.

    Of no distribution it is what all of them agree on: raises `DistributionsDisagreeError` where that is not every
    field. A constant that only one of them has is left out.
    """
    if name not in _blocks():
        return None
    marks, lines = _blocks()[name]
    kept = [line.partition(" @")[0] for line in lines if _is_of(line, distribution)]
    if distribution:
        if marks and distribution not in marks:
            raise DistributionsDisagreeError(f"there is no {name} in {distribution}, only in {_listed(marks)}")
    elif marks:
        raise DistributionsDisagreeError(f"{name} is in {_listed(marks)} only")
    elif apart := [line for line in lines if " @" in line and "=" not in line]:
        field, _, of = apart[0].partition(" @")
        raise DistributionsDisagreeError(f"the field `{field}` of {name} is in {_listed('@' + of)} only")
    constants = tuple(_constant(match) for line in kept if (match := _CONSTANT.fullmatch(line)))
    return Interface(name, tuple(_field(line) for line in kept if "=" not in line.replace("<=", "")), constants)


def _is_of(line: str, distribution: str) -> bool:
    return " @" not in line or (bool(distribution) and f" @{distribution}" in line)


def _listed(marks: str) -> str:
    return " and ".join(mark.removeprefix("@").capitalize() for mark in marks.split())


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
