"""As a compiler says it: the place, the line with a caret, the other places, the cure; in colour on a terminal."""

from __future__ import annotations

import functools
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

from rich.box import SIMPLE
from rich.console import Console
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from generator.diagnostics import Diagnostic, Severity, Span
from generator.lint_engine import Linted
from generator.pinned_numbers import Pinned
from roverlink.reports.places import from_here, told

_STYLES = {
    Severity.FATAL: "bold red",
    Severity.ERROR: "bold red",
    Severity.WARNING: "bold yellow",
    Severity.HINT: "bold cyan",
}
_TAB = "    "


def write(linted: Linted) -> None:
    """Print the findings, and how many there are of each severity."""
    console = Console(file=sys.stdout, highlight=False, soft_wrap=True)
    for finding in linted.findings:
        console.print(Text("\n").join([*_lines(finding, linted), Text()]))
    if linted.subject.past is not None and linted.subject.past.pinned:
        console.print(_matrix(linted.subject.past.pinned))
    console.print(_summary(linted))


def _matrix(pinned: Sequence[Pinned]) -> Table:
    """Which numbers any two consumers disagree about."""
    table = Table("", *(escape(one.pin.consumer) for one in pinned), box=SIMPLE)
    for one in pinned:
        cells = (", ".join(map(str, one.disagreements(other))) or "agree" for other in pinned)
        table.add_row(escape(one.pin.consumer), *("" if other is one else cell for other, cell in zip(pinned, cells)))
    return table


def _lines(finding: Diagnostic, linted: Linted) -> Iterator[Text]:
    style = _STYLES[finding.severity]
    yield Text.assemble(
        (f"{from_here(finding.span, linted)}: ", "bold"),
        (f"{finding.severity.value}[{finding.rule.id}]", style),
        f" {finding.message}",
    )
    yield from _quoted(finding.span, linted.folder, style)
    for span, what in finding.also:
        yield Text(f"  {from_here(span, linted)}: {told(span, what, linted)}")
    if finding.help:
        yield Text.assemble("  ", ("help: ", "bold"), finding.help)


def _quoted(span: Span, folder: Path, style: str) -> Iterator[Text]:
    """The line that a place is in, with a caret below the column; nothing where it cannot be read."""
    lines = _source(folder / span.file)
    if not 0 < span.line <= len(lines) or not span.column:
        return
    line, number = lines[span.line - 1], str(span.line)
    before = line[: span.column - 1].replace("\t", _TAB)
    yield Text(f"{number} | {line.rstrip()}".replace("\t", _TAB))
    yield Text.assemble(f"{' ' * len(number)} | {' ' * len(before)}", ("^", style))


@functools.cache
def _source(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return []


def _summary(linted: Linted) -> str:
    counted = Counter(finding.severity for finding in linted.findings)
    parts = [f"{count} {_plural(severity.value, count)}" for severity in Severity if (count := counted[severity])]
    return ", ".join(parts) if parts else "nothing to find fault with"


def _plural(word: str, count: int) -> str:
    word = "fatal error" if word == "fatal" else word
    return word if count == 1 else f"{word}s"
