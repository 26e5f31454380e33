"""Diagnostics as text for the terminal: place, message, source line with a caret below it, related places, and help."""

from __future__ import annotations

import dataclasses
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from roverlink.generator import source_files
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Severity, Span, Use
from roverlink.generator.git import Commit
from roverlink.generator.source_files import visible
from roverlink.numerals import counted

if TYPE_CHECKING:
    from rich.text import Text

_STYLES = {
    Severity.FATAL: "bold red",
    Severity.ERROR: "bold red",
    Severity.WARNING: "bold yellow",
    Severity.HINT: "bold cyan",
}
_TAB = "    "
_GAP = "   "  # between two columns
_MOST_USES = 6
_WIDTH = 100  # columns of the output if it is no terminal, such as the log of a CI server


@dataclasses.dataclass(frozen=True, slots=True)
class Sources:
    """Access to the source files that diagnostics name, to show the source line of each diagnostic."""

    folder: Path
    """Folder to which the paths in diagnostics are relative."""
    texts: Mapping[str, str] = dataclasses.field(default_factory=dict)
    """Texts that replace the files on disk, by path, such as mapping.yaml with a new row that is not written yet."""
    commit_of: Callable[[Span], Commit | None] = lambda _: None
    """Function that returns the commit that last changed the line at a place; None if the commit is not known."""
    _read: dict[str, list[str]] = dataclasses.field(default_factory=dict)

    def from_here(self, span: Span) -> Span:
        """Return the place ``span`` with its path relative to the current folder instead of `folder`.

        If the file does not exist, the path stays as it is.
        """
        path = self.folder / span.file
        return dataclasses.replace(span, file=os.path.relpath(path)) if path.exists() else span

    def file_of(self, use: Use) -> str:
        """Return the path of the file with a use, relative to the current folder. Today it may not exist."""
        return os.path.relpath(self.folder / use.place.file)

    def with_commit(self, span: Span, what: str) -> str:
        """Return ``what``, a text about the place ``span``, followed by the commit that last changed the place's line.

        If the commit is not known, return only ``what``.
        """
        commit = self.commit_of(span)
        return f"{what} ({commit})" if commit else what

    def line(self, span: Span) -> str:
        """Return the source line at the place ``span``; an empty text if the line cannot be read."""
        if not span.line:  # a diagnostic about the whole file; the file may be a pipe or a device
            return ""
        if span.file not in self._read:
            text = self.texts.get(span.file)
            text = source_files.quoted_text(self.folder / span.file) if text is None else text
            # Only a line feed ends a line for protoc; Python and YAML know other line ends.
            self._read[span.file] = text.split("\n") if span.file.endswith(".proto") else text.splitlines()
        lines = self._read[span.file]
        return lines[span.line - 1].rstrip() if 0 < span.line <= len(lines) else ""


def show(findings: Iterable[Diagnostic], sources: Sources, stream: TextIO) -> None:
    """Print diagnostics with their source lines; in colour if ``stream`` is a terminal and NO_COLOR is not set."""
    if not (findings := list(findings)):
        return
    from rich.console import Console  # imported here: the import is slow, and a run without findings needs none of it
    from rich.text import Text

    console = Console(file=stream, highlight=False, soft_wrap=True)
    width = console.width if console.is_terminal else _WIDTH
    for finding in findings:
        console.print(Text("\n").join([*_lines(finding, sources, width), Text()]))


def show_error(error: DiagnosticsError, folder: Path) -> None:
    """Print the diagnostics of an error because of which a command cannot continue, on standard error.

    ``folder`` is the folder of the table or of the .proto files. The paths in the diagnostics are relative to it.
    """
    show_without_hints(error.findings, Sources(folder, error.texts), sys.stderr)


def show_without_hints(findings: Iterable[Diagnostic], sources: Sources, stream: TextIO) -> None:
    """Print diagnostics as `show` does, but of the hints only their number, so that they do not hide an error."""
    findings = list(findings)
    hints = [finding.rule.id for finding in findings if finding.severity is Severity.HINT]
    show((finding for finding in findings if finding.severity is not Severity.HINT), sources, stream)
    if hints:
        rules = ", ".join(sorted(set(hints)))
        print(f"{counted(len(hints), 'hint')} ({rules}), which `roverlink lint` shows", file=stream)


def _lines(finding: Diagnostic, sources: Sources, width: int) -> Iterator[Text]:
    from rich.text import Text

    style = _STYLES[finding.severity]
    yield Text.assemble(
        (f"{sources.from_here(finding.span)}: ", "bold"),
        (f"{finding.severity.value}[{finding.rule.id}]", style),
        f" {finding.message}",
    )
    if (line := sources.line(finding.span)) and finding.span.column:
        # Tabs have other widths on other terminals, so the line is shown without them, and the caret stands below its
        # column.
        number = str(finding.span.line)
        whole, before = (visible(part.replace("\t", _TAB)) for part in (line, line[: finding.span.column - 1]))
        yield Text(f"{number} | {whole}")
        yield Text.assemble(f"{' ' * len(number)} | {' ' * len(before)}", ("^", style))
    yield from (Text(f"  {line}".rstrip()) for line in beside(finding.uses, sources, width - 2))
    for span, what in finding.also:
        yield Text(f"  {sources.from_here(span)}: {sources.with_commit(span, what)}")
    if finding.help:
        yield Text.assemble("  ", ("help: ", "bold"), finding.help)


def beside(uses: Sequence[Use], sources: Sources, width: int) -> list[str]:
    """Return the declarations of a number with their commits as lines, side by side in columns.

    If the columns need more than ``width`` characters, the declarations stand one below the other.
    """
    from rich.cells import cell_len, set_cell_size

    if len(uses) > _MOST_USES:
        first = f"... and {len(uses) - _MOST_USES} earlier declarations, which `roverlink number history` lists"
        return [first, *beside(uses[-_MOST_USES:], sources, width)]
    if not uses:
        return []
    column = (width - len(_GAP) * (len(uses) - 1)) // len(uses)
    blocks = [use.text(sources.file_of(use), max(column, 0)) for use in uses]
    widths = [max(map(cell_len, block)) for block in blocks]
    if len(uses) == 1 or max(widths) > column:
        return [line for use in uses for line in use.text(sources.file_of(use), width) if line]
    rows = zip_longest(*blocks, fillvalue="")
    return [_GAP.join(map(set_cell_size, row, widths)).rstrip() for row in rows]
