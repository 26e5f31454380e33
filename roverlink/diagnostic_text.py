"""Diagnostics as text for the terminal: place, message, source line with a caret below it, related places, and help."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from roverlink.generator import source_files
from roverlink.generator.diagnostics import Diagnostic, DiagnosticsError, Severity, Span
from roverlink.generator.git import Commit

if TYPE_CHECKING:
    from rich.text import Text

_STYLES = {
    Severity.FATAL: "bold red",
    Severity.ERROR: "bold red",
    Severity.WARNING: "bold yellow",
    Severity.HINT: "bold cyan",
}
_TAB = "    "


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
            self._read[span.file] = (_text_of(self.folder / span.file) if text is None else text).splitlines()
        lines = self._read[span.file]
        return lines[span.line - 1].rstrip() if 0 < span.line <= len(lines) else ""


def _text_of(path: Path) -> str:
    if not path.is_file():  # reading a pipe or a device may never end
        return ""
    try:
        return source_files.read(path.parent, path.name).decode("utf-8", errors="replace")
    except OSError:
        return ""


def show(findings: Iterable[Diagnostic], sources: Sources, stream: TextIO) -> None:
    """Print diagnostics with their source lines; in colour if ``stream`` is a terminal and NO_COLOR is not set."""
    if not (findings := list(findings)):
        return
    from rich.console import Console  # imported here: the import is slow, and a run without findings needs none of it
    from rich.text import Text

    console = Console(file=stream, highlight=False, soft_wrap=True)
    for finding in findings:
        console.print(Text("\n").join([*_lines(finding, sources), Text()]))


def show_error(error: DiagnosticsError, folder: Path, stream: TextIO) -> None:
    """Print the diagnostics of an error because of which a command cannot continue.

    ``folder`` is the folder of the table or of the .proto files. The paths in the diagnostics are relative to it.
    """
    show(error.findings, Sources(folder, error.texts), stream)


def _lines(finding: Diagnostic, sources: Sources) -> Iterator[Text]:
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
        number, before = str(finding.span.line), line[: finding.span.column - 1].replace("\t", _TAB)
        yield Text(f"{number} | {line}".replace("\t", _TAB))
        yield Text.assemble(f"{' ' * len(number)} | {' ' * len(before)}", ("^", style))
    for span, what in finding.also:
        yield Text(f"  {sources.from_here(span)}: {sources.with_commit(span, what)}")
    if finding.help:
        yield Text.assemble("  ", ("help: ", "bold"), finding.help)
