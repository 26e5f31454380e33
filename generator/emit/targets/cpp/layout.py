"""Laying out C++ in the style of ROS 2, with lines as long as elsewhere in this project."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable, Iterator

LINE_LENGTH = 120

_ESCAPES = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\r": "\\r", "\t": "\\t"}


def indented(lines: Iterable[str], depth: int = 1) -> list[str]:
    """Lines at a depth of indentation."""
    return ["  " * depth + line if line else "" for line in lines]


def block(head: str, lines: Iterable[str]) -> list[str]:
    """What belongs to a condition or a loop, in braces."""
    return [f"{head} {{", *indented(lines), "}"]


def body(lines: Iterable[str]) -> str:
    """The statements of a function, each line that is too long broken behind a bracket, a comma or an assignment."""
    return "\n".join(part for line in indented(lines) for part in _broken(line))


def signature(returns: str, name: str, parameters: Iterable[str], end: str = "", margin: str = "") -> str:
    """The head of a function; its parameters on a line of their own where it is too long."""
    listed = ", ".join(parameters)
    flat = f"{margin}{returns} {name}({listed}){end}"
    return flat if len(flat) <= LINE_LENGTH else f"{margin}{returns} {name}(\n{margin}  {listed}){end}"


def _broken(line: str) -> Iterator[str]:
    margin = " " * (len(line) - len(line.lstrip()) + 2)
    while len(line) > LINE_LENGTH and (places := _places(line)):
        place = max(places)
        yield line[:place].rstrip()
        line = margin + line[place:].lstrip()
    yield line


def _places(line: str) -> list[int]:
    """Where a line may end so that it fits: the places outside of most brackets."""
    start = len(line) - len(line.lstrip())
    depth, quoted, found = 0, False, dict[int, int]()
    for end, character in enumerate(line[:LINE_LENGTH], start=1):
        if character == '"' and not line[: end - 1].endswith("\\"):
            quoted = not quoted
        if quoted:
            continue
        depth -= character in ")]}"
        if (character == "(" and line[end : end + 1] != ")") or line[end - 1 : end + 1] in (", ", "= "):
            found[end] = depth
        depth += character in "([{"
    outermost = min(found.values(), default=0)
    return [end for end, depth in found.items() if depth == outermost and end > start + 2]


def comment(text: str, margin: str = "") -> str:
    """A documentation comment, filled."""
    lines = textwrap.wrap(text, LINE_LENGTH - len(margin) - 4, break_long_words=False, break_on_hyphens=False)
    return "\n".join(f"{margin}/// {line}" for line in lines)


def includes(headers: Iterable[str]) -> str:
    """Include directives of headers by their names, each once, in order."""
    return "\n".join(f"#include <{header}>" for header in sorted(set(headers)))


def guard(path: str) -> str:
    """The macro that guards a header: ``COMMS__HANDLERS__IMU_INFO_HPP_``."""
    return path.replace("/", "__").replace(".", "_").upper() + "_"


def text_literal(text: str) -> str:
    r"""A text as a string literal in UTF-8.

    >>> print(text_literal('5 "°"'))
    "5 \"°\""
    """
    escaped = (_ESCAPES.get(one) or (one if one.isprintable() else _octal(one)) for one in text)
    return f'"{"".join(escaped)}"'


def literal(value: object) -> str:
    """A constant of a primitive type, or a text."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return text_literal(value)
    if isinstance(value, float) and not math.isfinite(value):
        if math.isnan(value):
            return "std::numeric_limits<double>::quiet_NaN()"
        return f"{'-' if value < 0 else ''}std::numeric_limits<double>::infinity()"
    return repr(value)


def _octal(character: str) -> str:
    return "".join(f"\\{byte:03o}" for byte in character.encode())
