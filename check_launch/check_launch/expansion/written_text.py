"""Substitutions as YAML and XML launch files write them: ``$(var namespace)/camera``."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any

from check_launch.expansion import substitutions as of_launch

_NAME = re.compile(r"[A-Za-z][\w-]*")


class WrongTextError(Exception):
    """Raised for a text that is not valid in a launch file."""


def parse_text(text: str) -> Any:
    """Return a text with substitutions as a list of texts and substitutions, or as it is if it has none.

    Raises `WrongTextError` if a substitution has no end, or is not known.
    """
    if "$(" not in text:
        return text
    parts, rest = _parts(text, 0, "")
    if rest != len(text):
        raise WrongTextError(f"the text {text!r} has a bracket that does not belong to a substitution")
    return parts


def _parts(text: str, position: int, ends: str) -> tuple[list[Any], int]:
    """Read up to one of the characters in ``ends``, or to the end of the text."""
    parts: list[Any] = []
    plain = ""
    while position < len(text) and text[position] not in ends:
        if text.startswith("\\$", position) or (ends and text[position] == "\\" and position + 1 < len(text)):
            plain += text[position + 1]
            position += 2
        elif text.startswith("$(", position):
            if plain:
                parts.append(plain)
                plain = ""
            substitution, position = _substitution(text, position + 2)
            parts.append(substitution)
        else:
            plain += text[position]
            position += 1
    return ([*parts, plain] if plain else parts), position


def _substitution(text: str, position: int) -> tuple[Any, int]:
    match = _NAME.match(text, position)
    if match is None:
        raise WrongTextError(f"after '$(' there is no name of a substitution in {text!r}")
    name, position = match[0], match.end()
    arguments: list[Any] = []
    while True:
        while position < len(text) and text[position] in " \t\n":
            position += 1
        if position >= len(text):
            raise WrongTextError(f"the substitution $({name} has no closing bracket in {text!r}")
        if text[position] == ")":
            break
        quote = text[position] if text[position] in "'\"" else ""
        parts, position = _parts(text, position + len(quote), quote or " \t\n)")
        if quote:
            if position >= len(text):
                raise WrongTextError(f"the quotation mark {quote} after $({name} is not closed in {text!r}")
            position += 1
        arguments.append(parts[0] if len(parts) == 1 else parts)
    if name not in _MADE:
        raise WrongTextError(f"unknown substitution $({name} ...)")
    try:
        return _MADE[name](arguments), position + 1
    except (IndexError, TypeError) as error:
        raise WrongTextError(f"the substitution $({name} ...) has too few or too many arguments") from error


def _spaced(arguments: list[Any]) -> list[Any]:
    """Join arguments with spaces, as the expression after ``$(eval`` may be written without quotation marks."""
    joined: list[Any] = []
    for argument in arguments:
        joined += [*([" "] if joined else []), argument]
    return joined


_MADE: Mapping[str, Callable[[list[Any]], Any]] = {
    "var": lambda args: of_launch.LaunchConfiguration(args[0], default=args[1] if len(args) > 1 else None),
    "env": lambda args: of_launch.EnvironmentVariable(args[0], default_value=args[1] if len(args) > 1 else None),
    "optenv": lambda args: of_launch.EnvironmentVariable(args[0], default_value=args[1] if len(args) > 1 else ""),
    "eval": lambda args: of_launch.PythonExpression(_spaced(args)),
    "find-pkg-share": lambda args: of_launch.FindPackageShare(args[0]),
    "find-pkg-prefix": lambda args: of_launch.FindPackagePrefix(args[0]),
    "dirname": lambda _: of_launch.ThisLaunchFileDir(),
    "filename": lambda _: of_launch.ThisLaunchFile(),
    "anon": lambda args: of_launch.AnonName(args[0]),
    "not": lambda args: of_launch.NotSubstitution(args[0]),
    "and": lambda args: of_launch.AndSubstitution(args[0], args[1]),
    "or": lambda args: of_launch.OrSubstitution(args[0], args[1]),
    "equals": lambda args: of_launch.EqualsSubstitution(args[0], args[1]),
    "not-equals": lambda args: of_launch.NotEqualsSubstitution(args[0], args[1]),
    "if": lambda args: of_launch.IfElseSubstitution(*args),
    **dict.fromkeys(
        (
            "command",
            "exec-in-pkg",
            "exec-in-package",
            "find-exec",
            "param",
            "log_dir",
            "launch_log_dir",
            "xacro",
            "file-content",
        ),
        lambda args: of_launch.UnknownSubstitution(*args),
    ),
}
