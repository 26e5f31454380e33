"""Constants and comments as C++ writes them."""

from __future__ import annotations

import math

_ESCAPES = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\r": "\\r", "\t": "\\t"}


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


def comment_lines(text: str) -> list[str]:
    """The lines of a comment, each with the space that separates it from the slashes.

    A backslash at the end of a line would make the next line a comment, too; a period follows it.
    """
    lines = [f"{line}." if line.endswith("\\") else line for line in text.splitlines()]
    return [f" {line}" if line else "" for line in lines]


def _octal(character: str) -> str:
    return "".join(f"\\{byte:03o}" for byte in character.encode())
