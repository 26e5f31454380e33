"""Findings of `roverlink lint` as text for people.

The text consists of the diagnostics, a table of the numbers that projects use differently (option ``--pins``), and a
last line such as ``1 error, 2 warnings``.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Sequence

from rich.box import SIMPLE
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from roverlink.diagnostic_text import show
from roverlink.generator.diagnostics import Severity
from roverlink.generator.lint.pinned_numbers import Pinned
from roverlink.generator.lint.project import Linted
from roverlink.lint_scope import sources


def write(linted: Linted) -> None:
    """Print the findings on standard output, and how many findings there are of each severity."""
    console = Console(file=sys.stdout, highlight=False, soft_wrap=True)
    show(linted.findings, sources(linted), sys.stdout)
    if linted.context.past is not None and linted.context.past.pinned:
        console.print(_matrix(linted.context.past.pinned))
    console.print(_summary(linted))


def _matrix(pinned: Sequence[Pinned]) -> Table:
    """Return a table with a row and a column for each project that uses the .proto files.

    A cell holds the numbers that two projects use differently, because they use different commits of the .proto files.
    """
    table = Table("", *(escape(one.pin.consumer) for one in pinned), box=SIMPLE)
    for one in pinned:
        cells = (", ".join(map(str, one.disagreements(other))) or "agree" for other in pinned)
        table.add_row(escape(one.pin.consumer), *("" if other is one else cell for other, cell in zip(pinned, cells)))
    return table


def _summary(linted: Linted) -> str:
    counted = Counter(finding.severity for finding in linted.findings)
    parts = [f"{count} {_plural(severity.value, count)}" for severity in Severity if (count := counted[severity])]
    return ", ".join(parts) if parts else "No problems found."


def _plural(word: str, count: int) -> str:
    word = "fatal error" if word == "fatal" else word
    return word if count == 1 else f"{word}s"
