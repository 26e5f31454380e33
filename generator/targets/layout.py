"""Laying out Python as black does: on one line where it fits, else one item a line with a trailing comma.

black leaves both forms as they are, so generated code is black-formatted without running black over it, which would
take forty times as long as making it; a test and `make lint` hold it to that.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

LINE_LENGTH = 88


@dataclass(frozen=True, slots=True)
class Group:
    """Something in brackets: ``head`` ends with the opening one, ``tail`` starts with the closing one."""

    head: str
    items: Sequence[str | Group | Comprehension]
    tail: str

    def flat(self) -> str:
        """On one line."""
        return f"{self.head}{', '.join(_flat(item) for item in self.items)}{self.tail}"

    def lines(self, indent: int) -> list[str]:
        """One item a line."""
        body = [line for item in self.items for line in _item_lines(item, indent + 4)]
        return [f"{' ' * indent}{self.head}", *body, f"{' ' * indent}{self.tail}"]


@dataclass(frozen=True, slots=True)
class Comprehension:
    """A list comprehension."""

    head: str
    element: str
    loop: str
    tail: str

    def flat(self) -> str:
        """On one line."""
        return f"{self.head}{self.element} {self.loop}{self.tail}"

    def lines(self, indent: int) -> list[str]:
        """Its inside on one line, or element and loop on two."""
        inner = f"{' ' * (indent + 4)}{self.element} {self.loop}"
        parts = (
            [inner] if len(inner) <= LINE_LENGTH else [" " * (indent + 4) + part for part in (self.element, self.loop)]
        )
        return [f"{' ' * indent}{self.head}", *parts, f"{' ' * indent}{self.tail}"]


def _flat(item: str | Group | Comprehension) -> str:
    return item if isinstance(item, str) else item.flat()


def _item_lines(item: str | Group | Comprehension, indent: int, force: bool = False) -> list[str]:
    flat = f"{' ' * indent}{_flat(item)},"
    if isinstance(item, str) or (len(flat) <= LINE_LENGTH and not force):
        return [flat]
    *lines, last = item.lines(indent)
    return [*lines, f"{last},"]


def statement(group: Group | Comprehension, indent: int = 0) -> str:
    """A statement at a depth of indentation, without that indentation on its first line."""
    if indent + len(group.flat()) <= LINE_LENGTH:
        return group.flat()
    return "\n".join(group.lines(indent)).lstrip(" ")


def entry(head: str, open: str, items: Sequence[str], close: str, indent: int) -> str:
    """An entry of a literal or a call, with its comma: a tuple or a mapping, always one item a line.

    A tuple of one is the exception: to black, its comma is no wish for more lines.
    """
    if not items:
        return f"{head}{open}{close},"
    single = f"{head}({items[0]},),"
    if open == "(" and len(items) == 1 and indent + len(single) <= LINE_LENGTH:
        return single
    return "\n".join(_item_lines(Group(f"{head}{open}", items, close), indent, force=True)).lstrip(" ")


def import_from(module: str, names: Iterable[str]) -> str:
    """A ``from ... import ...``, its names in isort's order."""
    ordered = sorted(names, key=natural_order)
    flat = f"from {module} import {', '.join(ordered)}"
    if len(flat) <= LINE_LENGTH:
        return flat
    return "\n".join(Group(f"from {module} import (", ordered, ")").lines(0))


def natural_order(name: str) -> list[tuple[str, int]]:
    """A sort key by which numbers inside names count as numbers: ``UInt8`` before ``UInt32``."""
    return [(text.lower(), int(digits or 0)) for text, digits in re.findall(r"(\D*)(\d*)", name)]


def docstring(text: str, indent: int) -> str:
    """A docstring, without the indentation of its first line."""
    text = text.expandtabs(4).replace("\\", "\\\\").replace('"""', "'''")
    lines = [line.rstrip() for line in text.strip().splitlines()]
    if len(lines) == 1:
        end = " " if lines[0].endswith('"') else ""
        return f'"""{lines[0]}{end}"""'
    margin = " " * indent
    return "\n".join([f'"""{lines[0]}', *(f"{margin}{line}".rstrip() for line in lines[1:]), f'{margin}"""'])
