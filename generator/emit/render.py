"""Templates, and the header of every generated file."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from roverlink.generator.emit.python_format import fitted, literal

Files = Iterator[tuple[str, str]]
"""Output of a target: each file's path, relative to the table, and its text."""

REGENERATE = "Regenerate with: roverlink generate"


def shipped(folder: str) -> Path:
    """Return a folder that is installed with the generator: ``templates`` or ``cpp``."""
    return Path(__file__).parents[2] / folder


# trim_blocks and lstrip_blocks: a line with only a block tag leaves no empty line in the output. keep_trailing_newline:
# Jinja drops the last newline by default, but files must end with one.
SETTINGS: dict[str, Any] = {
    "trim_blocks": True,
    "lstrip_blocks": True,
    "keep_trailing_newline": True,
    "undefined": StrictUndefined,
    "autoescape": False,
}
"""Settings of Jinja for shipped and users' templates. An undefined name is an error, not an empty text."""


@cache
def environment() -> Environment:
    """Return the Jinja environment of the shipped templates."""
    own = Environment(loader=FileSystemLoader(shipped("templates")), **SETTINGS)  # noqa: S701  # source text, not HTML
    own.filters |= {"docstring": _docstring, "fitted": fitted, "literal": literal}
    return own


def render(template: str, **view: Any) -> str:
    """Return the rendered text of a template."""
    return environment().get_template(template).render(view)


def _docstring(text: str) -> str:
    """Return a Python docstring with the indentation of the text's first line."""
    margin = " " * (len(text) - len(text.lstrip(" ")))
    escaped = text.expandtabs(4).replace('"""', "'''").strip()
    first, *others = (line.removeprefix(margin).rstrip() for line in escaped.splitlines())
    quotes = 'r"""' if "\\" in escaped else '"""'
    if not others:
        end = " " if first.endswith(('"', "\\")) else ""
        return f'{margin}{quotes}{first}{end}"""\n'
    lines = [f"{quotes}{first}", *others, '"""']
    return "".join(f"{margin if line else ''}{line}\n" for line in lines)


def header(origin: str, open: str = "#", close: str = "") -> str:
    """Return the two comment lines that open a generated file and name its origin."""
    return "\n".join(f"{open} {line}{close}" for line in (f"Generated from {origin}; do not edit.", f"{REGENERATE}"))
