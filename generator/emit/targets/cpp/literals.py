"""Conversion of constants and comments to C++ source code."""

from __future__ import annotations

import math

_ESCAPES = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\r": "\\r", "\t": "\\t"}


def text_literal(text: str) -> str:
    r"""Return a text as a C++ string literal in UTF-8.

    >>> print(text_literal('5 "°"'))
    "5 \"°\""
    """
    escaped = (
        _ESCAPES.get(character) or (character if character.isprintable() else _octal(character)) for character in text
    )
    return f'"{"".join(escaped)}"'


def literal(value: object) -> str:
    """Return a number, boolean or text as a C++ literal."""
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
    """Return a text as the lines of a C++ comment. The space after the slashes is included, the slashes are not.

    A backslash at the end of a line would continue the comment on the next line, so a period is added.
    """
    lines = [f"{line}." if line.endswith("\\") else line for line in text.splitlines()]
    return [f" {line}" if line else "" for line in lines]


# Octal escapes: a hexadecimal escape in C++ has no fixed length and would include digits that follow it.
def _octal(character: str) -> str:
    return "".join(f"\\{byte:03o}" for byte in character.encode())
