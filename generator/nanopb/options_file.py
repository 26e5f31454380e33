"""Reader of the .options file beside a .proto file.

Each line has a pattern, and the options for all names that match it: ``Note.* max_size:20``. ``//`` and ``#`` start a
comment anywhere in a line. ``/* ... */`` is a comment within one line.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from fnmatch import translate
from pathlib import Path, PurePosixPath

from roverlink.generator import source_files
from roverlink.generator.diagnostics import Diagnostic, Span, shown
from roverlink.generator.nanopb.option_rules import UnreadableNanopbOptions
from roverlink.generator.nanopb.options import OptionsError, Values, parse_options

_BLOCK_COMMENT = re.compile(r"/\*.*?\*/")
_LINE_COMMENT = re.compile(r"(//|#).*")


@dataclass(frozen=True, slots=True)
class OptionsLine:
    """A line of a .options file: a pattern, and options for all names that match it."""

    pattern: str
    matches: Callable[[str], object]
    """Function that returns a true value if a full name matches the pattern."""
    values: Values
    span: Span


def options_file_of(proto: str) -> str:
    """Return the path of a .proto file's .options file; both are relative to the root of the .proto files."""
    return PurePosixPath(proto).with_suffix(".options").as_posix()


def read_options_file(root: Path, name: str, shown_root: str, findings: list[Diagnostic]) -> list[OptionsLine]:
    """Return the lines of a .options file; empty if the file does not exist.

    ``name`` is the file's path below ``root``. Lines that cannot be read are reported and left out.
    """
    place = shown(shown_root, name)
    try:
        text = source_files.read_text(root, name)
    except FileNotFoundError:
        return []
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else f"it is not UTF-8: {error.reason}"
        findings.append(UnreadableNanopbOptions.at(Span(place), f"the file cannot be read: {reason}"))
        return []
    # nanopb reads a text file. Unlike splitlines(), it does not end a line at the other separators of Unicode.
    lines = (_line(raw, Span(place, number), findings) for number, raw in enumerate(text.split("\n"), 1))
    return [line for line in lines if line]


def _line(raw: str, at: Span, findings: list[Diagnostic]) -> OptionsLine | None:
    bare = _LINE_COMMENT.sub("", _BLOCK_COMMENT.sub("", raw)).strip()
    if not bare:
        return None
    pattern, *rest = bare.split(None, 1)
    span = Span(at.file, at.line, raw.find(pattern) + 1)
    if not rest:
        help = f"for example, write `{pattern} max_size:16`"
        findings.append(UnreadableNanopbOptions.at(span, f"the pattern {pattern!r} has no options", help))
        return None
    try:
        values = parse_options(rest[0])
    except OptionsError as error:
        findings.append(UnreadableNanopbOptions.at(_place(error, raw, rest[0], span), str(error), error.help))
        return None
    return OptionsLine(pattern, re.compile(translate(pattern)).match, values, span)


def _place(error: OptionsError, raw: str, options: str, otherwise: Span) -> Span:
    """Return the place of a mistake in the line ``raw``; ``otherwise`` if its column cannot be found."""
    start = raw.rfind(options)
    return Span(otherwise.file, otherwise.line, start + error.column) if error.column and start >= 0 else otherwise
