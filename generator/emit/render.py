"""Rendering of the templates that are installed with the generator, and the header of every generated file."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jinja2 import Environment

Files = Iterator[tuple[str, str]]
"""Files that a target generates: pairs of a path, such as ``generated/registry.py``, and the text of the file."""

REGENERATE = "Regenerate with: roverlink generate"
_HEADER_WITHIN = 400  # characters; the header is at the top


def carries_header(text: str) -> bool:
    """Return True if a text starts with the header of generated files (see `header`)."""
    return REGENERATE in text[:_HEADER_WITHIN]


def shipped(folder: str) -> Path:
    """Return the path of a folder that is installed with the generator: ``templates`` or ``cpp``."""
    return Path(__file__).parents[2] / folder


# trim_blocks and lstrip_blocks: a line with only a block tag leaves no empty line in the output. keep_trailing_newline:
# Jinja drops the last newline by default, but files must end with one.
SETTINGS: dict[str, Any] = {
    "trim_blocks": True,
    "lstrip_blocks": True,
    "keep_trailing_newline": True,
    "autoescape": False,
}
"""Settings of Jinja for our own templates and for those of users."""


@cache
def environment() -> Environment:
    """Return the Jinja environment that renders the installed templates."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined  # here: the help of a command needs no Jinja

    from roverlink.generator.emit.python_format import fitted, literal

    loader = FileSystemLoader(shipped("templates"))
    own = Environment(loader=loader, undefined=StrictUndefined, **SETTINGS)  # noqa: S701  # source text, not HTML
    own.filters |= {"docstring": _docstring, "fitted": fitted, "literal": literal}
    return own


def render(template: str, **view: Any) -> str:
    """Return the text that a template produces; the template sees the variables in ``view``."""
    return environment().get_template(template).render(view)


def _docstring(text: str) -> str:
    """Return a text as a Python docstring with quotes. The docstring is indented like the first line of the text."""
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
    """Return the two comment lines at the top of a generated file; ``origin`` names the inputs of the file.

    ``open`` and ``close`` start and end a comment in the language of the file, such as ``<!--`` and `` -->``.
    """
    return "\n".join(f"{open} {line}{close}" for line in (f"Generated from {origin}; do not edit.", f"{REGENERATE}"))
