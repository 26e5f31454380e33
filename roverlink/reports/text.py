"""Findings as text for people.

The text consists of the diagnostics, a table of how the projects that use the .proto files read each other (option
``--pins``), and a last line such as ``1 error, 2 warnings``.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from roverlink.diagnostic_text import show
from roverlink.generator.diagnostics import Diagnostic, Rule, Severity
from roverlink.generator.protos.proto_rules import ProtoDoesNotCompile, UnreadableProto
from roverlink.numerals import counted
from roverlink.reports.reported import Reported

if TYPE_CHECKING:  # slow to import: it reads a project's earlier states
    from rich.table import Table

    from roverlink.generator.lint.pinned_states import PinnedStates

NO_PROBLEMS = "No problems found."
"""Last line of the output if there are no findings."""
_CELL = len("compatible") + 3  # a column with its padding and the gap to the next one
_PADDING_OF_NAMES = 4
_OF_FILES = (ProtoDoesNotCompile, UnreadableProto)
_MOST_OF_FILES = 20  # findings of each of these rules


def write(reported: Reported) -> None:
    """Print the findings on standard output, and how many findings there are of each severity."""
    shown, left_out = _shown(reported.shown)
    show(shown, reported.sources, sys.stdout)
    for rule, count in left_out.items():
        print(f"... and {counted(count, 'more error')} {rule.id}; is this the right folder of .proto files?\n")
    pinned = reported.pinned
    if pinned and len(pinned.states) > 1:
        from rich.console import Console  # here: rich is slow to import, and findings need none

        console = Console(file=sys.stdout, highlight=False, soft_wrap=True)
        with console.capture() as matrix:
            # Soft wrapping would stop the folding of long names.
            console.print(*_matrix(pinned, console.width), sep="", soft_wrap=False)
        for line in matrix.get().splitlines():
            print(line.rstrip())  # rich fills each line with spaces up to the width of the table
    print(_summary(reported))
    if reported.extent:
        print(f"{reported.extent}.")


def _shown(findings: Iterable[Diagnostic]) -> tuple[list[Diagnostic], Counter[type[Rule]]]:
    """Return the findings to print, and how many others there are of each rule.

    From a folder that is not the one of the .proto files, hundreds of files may not be readable.
    """
    shown, seen = list[Diagnostic](), Counter[type[Rule]]()
    for finding in findings:
        seen[finding.rule] += finding.rule in _OF_FILES
        if seen[finding.rule] <= _MOST_OF_FILES:
            shown.append(finding)
    return shown, Counter({rule: count - _MOST_OF_FILES for rule, count in seen.items() if count > _MOST_OF_FILES})


def _matrix(pinned: PinnedStates, width: int) -> Iterator[Table]:
    """Yield tables that say how two states of the .proto files read each other; each table fits ``width`` characters.

    Each row is a state, named after the projects that have it, with its number. The columns have the same numbers.
    """
    from rich.box import SIMPLE
    from rich.markup import escape
    from rich.table import Table

    names = [f"{number} {escape(', '.join(state.names))}" for number, state in enumerate(pinned.states, 1)]
    of_names = min(max(map(len, names)), width // 4)
    fitting = max(1, (width - of_names - _PADDING_OF_NAMES) // _CELL)
    for first in range(0, len(names), fitting):
        columns = range(first, min(first + fitting, len(names)))
        table = Table(box=SIMPLE)
        table.add_column("", width=of_names, overflow="fold")
        for column in columns:
            table.add_column(str(column + 1), width=len("compatible"))
        for row, name in enumerate(names):
            table.add_row(name, *(pinned.relation(row, column) for column in columns))
        yield table


def _summary(reported: Reported) -> str:
    severities = Counter(finding.severity for finding in reported.shown)
    parts = [f"{count} {_plural(severity.value, count)}" for severity in Severity if (count := severities[severity])]
    if not reported.left_out:
        return ", ".join(parts) if parts else NO_PROBLEMS
    return f"{', '.join(parts) if parts else 'No new problems found'} ({reported.left_out})"


def _plural(word: str, count: int) -> str:
    word = "fatal error" if word == "fatal" else word
    return word if count == 1 else f"{word}s"
