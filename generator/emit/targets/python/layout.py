"""Laying out Python as black does: on one line where it fits, else one item a line with a trailing comma.

black leaves both forms as they are, so generated code is black-formatted without running black over it, which would
take forty times as long as making it; a test and `make lint` hold it to that.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

LINE_LENGTH = 88


@dataclass(frozen=True, slots=True)
class Group:
    """Something in brackets: ``head`` ends with the opening one, ``tail`` starts with the closing one."""

    head: str
    items: Sequence[Item]
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
    """A list comprehension, or a generator."""

    head: str
    element: Item
    loop: str | Group
    tail: str

    def flat(self) -> str:
        """On one line."""
        return f"{self.head}{_flat(self.element)} {_flat(self.loop)}{self.tail}"

    def lines(self, indent: int) -> list[str]:
        """Its inside on one line, or element and loop on two."""
        parts = _one_or_more_lines(self.element, [self.loop], indent + 4)
        return [f"{' ' * indent}{self.head}", *parts, f"{' ' * indent}{self.tail}"]


@dataclass(frozen=True, slots=True)
class Conditional:
    """A value, or another where its condition does not hold."""

    head: str
    value: Item
    condition: str | Group | Comparison
    otherwise: str = "None"

    def flat(self) -> str:
        """On one line."""
        return f"{self.head}{_flat(self.value)} if {_flat(self.condition)} else {self.otherwise}"

    def lines(self, indent: int) -> list[str]:
        """In parentheses, on one line or on three."""
        clauses = [headed("if ", self.condition), f"else {self.otherwise}"]
        parts = _one_or_more_lines(self.value, clauses, indent + 4)
        return [f"{' ' * indent}{self.head}(", *parts, f"{' ' * indent})"]


@dataclass(frozen=True, slots=True)
class Comparison:
    """Whether two things are equal."""

    head: str
    left: str
    right: str

    def flat(self) -> str:
        """On one line."""
        return f"{self.head}{self.left} == {self.right}"

    def lines(self, indent: int) -> list[str]:
        """A side a line."""
        margin = " " * indent
        return [f"{margin}{self.head}{self.left}", f"{margin}== {self.right}"]


Item = str | Group | Comprehension | Conditional | Comparison


def _flat(item: Item) -> str:
    return item if isinstance(item, str) else item.flat()


def headed(head: str, item: Item) -> Item:
    """An item with something before it."""
    return f"{head}{item}" if isinstance(item, str) else replace(item, head=f"{head}{item.head}")


def _one_or_more_lines(value: Item, clauses: Sequence[Item], indent: int) -> list[str]:
    """A value and the clauses that belong to it, on one line where they fit, else on one each."""
    margin = " " * indent
    inner = f"{margin}{' '.join(map(_flat, [value, *clauses]))}"
    if len(inner) <= LINE_LENGTH:
        return [inner]
    parts = [part if isinstance(part, str) else statement(part, indent) for part in (value, *clauses)]
    return [f"{margin}{part}" for part in parts]


def _item_lines(item: Item, indent: int, force: bool = False) -> list[str]:
    flat = f"{' ' * indent}{_flat(item)},"
    if isinstance(item, str) or (len(flat) <= LINE_LENGTH and not force):
        return [flat]
    *lines, last = item.lines(indent)
    return [*lines, f"{last},"]


def line(text: str, indent: int) -> str:
    """A statement for which one line has to do; where it is too long, black is asked to leave it."""
    return text if indent + len(text) <= LINE_LENGTH else f"{text}  # fmt: skip"


def statement(group: Group | Comprehension | Conditional | Comparison, indent: int = 0) -> str:
    """A statement at a depth of indentation, without that indentation on its first line."""
    if indent + len(group.flat()) <= LINE_LENGTH:
        return group.flat()
    return "\n".join(group.lines(indent)).lstrip(" ")


def signature(name: str, parameters: Sequence[str], returns: str, indent: int) -> str:
    """The first line of a function, or its first lines."""
    flat = f"def {name}({', '.join(parameters)}) -> {returns}:"
    if indent + len(flat) <= LINE_LENGTH:
        return flat
    margin = " " * indent
    end = f"{margin}) -> {returns}:"
    ends = [end] if len(end) <= LINE_LENGTH else [f"{margin}) -> (", f"{margin}    {returns}", f"{margin}):"]
    return "\n".join([f"def {name}(", *(f"{margin}    {parameter}," for parameter in parameters), *ends])


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
    ordered = sorted(names, key=_member_order)
    flat = f"from {module} import {', '.join(ordered)}"
    if len(flat) <= LINE_LENGTH:
        return flat
    return "\n".join(Group(f"from {module} import (", ordered, ")").lines(0))


def in_import_order(lines: Iterable[str]) -> list[str]:
    """Statements made by `import_from`, each once, in isort's order."""
    return sorted(set(lines), key=lambda line: natural_order(line.split(" ", 2)[1]))


def import_block(imports: Iterable[tuple[str, str]]) -> tuple[str, ...]:
    """The import statements of modules and names, those of protobuf's library in a block before ours."""
    names: dict[str, set[str]] = {}
    statements: set[str] = set()
    for module, name in imports:
        if " as " in name:
            statements.add(import_from(module, [name]))
        else:
            names.setdefault(module, set()).add(name)
    statements |= {import_from(module, found) for module, found in names.items()}
    ordered = in_import_order(statements)
    theirs = [line for line in ordered if line.startswith("from google.")]
    ours = [line for line in ordered if line not in theirs]
    return (*theirs, "", *ours) if theirs else tuple(ours)


def _member_order(name: str) -> tuple[int, list[tuple[str, int]]]:
    """The order that isort gives imported names: constants, then classes, then the others."""
    kind = 0 if name.isupper() and len(name) > 1 else 1 if name[:1].isupper() else 2
    return kind, natural_order(name)


def natural_order(name: str) -> list[tuple[str, int]]:
    """A sort key by which numbers inside names count as numbers: ``UInt8`` before ``UInt32``."""
    return [(text.lower(), int(digits or 0)) for text, digits in re.findall(r"(\D*)(\d*)", name)]


def docstring(text: str, indent: int) -> str:
    """A docstring, without the indentation of its first line."""
    first, *others = text.expandtabs(4).replace('"""', "'''").strip().splitlines()
    lines = [first.rstrip(), *textwrap.dedent("\n".join(others)).splitlines()]
    open = 'r"""' if "\\" in text else '"""'
    if len(lines) == 1:
        end = " " if first.endswith(('"', "\\")) else ""
        return f'{open}{first}{end}"""'
    margin = " " * indent
    return "\n".join([f"{open}{lines[0]}", *(f"{margin}{line}".rstrip() for line in lines[1:]), f'{margin}"""'])
