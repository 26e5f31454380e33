"""The templates, and the header that every generated file starts with."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

Files = Iterator[tuple[str, str]]
"""What a target makes: the path of each file, relative to the table, and its text."""

REGENERATE = "Regenerate with: roverlink generate"


def shipped(folder: str) -> Path:
    """Return a folder that is installed together with the generator: ``templates`` or ``cpp``."""
    return Path(__file__).parents[2] / folder


SETTINGS: dict[str, Any] = {
    "trim_blocks": True,
    "lstrip_blocks": True,
    "keep_trailing_newline": True,
    "undefined": StrictUndefined,
    "autoescape": False,
}
"""Jinja's settings for our templates and for those of users: a name that is not there is an error."""


@cache
def environment() -> Environment:
    """Return Jinja for the templates that are installed together with the generator."""
    own = Environment(loader=FileSystemLoader(shipped("templates")), **SETTINGS)  # noqa: S701  # source text, not HTML
    own.filters |= {"docstring": _docstring, "literal": repr}
    return own


def render(template: str, **view: Any) -> str:
    """Return the text of a template."""
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
    """The two lines that say where a file comes from, as comments of its language."""
    return "\n".join(f"{open} {line}{close}" for line in (f"Generated from {origin}; do not edit.", f"{REGENERATE}"))
