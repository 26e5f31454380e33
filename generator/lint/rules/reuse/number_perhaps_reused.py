"""A number may have had different meanings in the history of the repository, and the names do not show it.

One commit gave the number another name, and the two names are similar, but not so similar that they certainly mean the
same: `speed` and `velocity`, `lattitude` and `latitude`. Or the new name says another unit: `reach_mm` and `reach_m`.
If the old name meant something else, boards and rovers that were built from these commits misread each other without
an error. `roverlink explain WIR116` says which names are doubtful.

Bad::

    message Motor { float speed = 1; }      // until May
    message Motor { float velocity = 1; }   // since then

Good::

    message Motor { reserved 1; reserved "speed"; float velocity = 2; }

If both names have the same meaning, the command in the help of the diagnostic accepts it, such as `roverlink lint
--history --accept rover.Motor:1`. Then the lint only reports further meanings (`roverlink explain HIS101`).
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.history import Kind
from roverlink.generator.lint.history_diagnostics import reported, reuses_by_number

RULE = Rule("HIS105", "number-perhaps-reused", __doc__, Severity.WARNING)
_CERTAIN = frozenset({Kind.REUSED, Kind.RETYPED, Kind.MEANING, Kind.REPLACED})


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each number that may have had several meanings in history.

    Numbers that another rule reports are left out.
    """
    worse = {(owner, number) for owner, number, _ in reuses_by_number(context, _CERTAIN)}
    for owner, number, reuses in reuses_by_number(context, frozenset({Kind.DOUBTFUL, Kind.UNIT})):
        if (owner, number) not in worse:
            yield reported(RULE, context, owner, number, reuses)
