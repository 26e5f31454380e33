"""A number had different meanings in the history of the repository.

A comparison of two states cannot find this. One commit deleted the number, and a later commit or another branch gave it
another meaning. Boards, basestations and rovers that were built from these commits misread each other without an
error.

Bad::

    message PBEnvelope { oneof payload { Foo foo = 18; } }   // in March
    message PBEnvelope { oneof payload { } }                 // in April
    message PBEnvelope { oneof payload { Bar bar = 18; } }   // in May

Good::

    message PBEnvelope { oneof payload { Bar bar = 22; } reserved 18; reserved "foo"; }

The past cannot be undone. If the number was only renamed, or if no machine confuses the meanings, the command in the
help of the diagnostic accepts it, such as `roverlink lint --history --accept 18`. The meanings are then in the ledger:
mapping.lock, or accepted-numbers.lock in a folder of .proto files without a table. A payload or field that has the
number today keeps it, and the lint only reports further meanings. A number that is free is never used again
(`roverlink explain ENV110`, `WIR111`, `WIR112`).
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.history import Kind
from roverlink.generator.lint.history_diagnostics import reported, reuses_by_number

RULE = Rule("HIS101", "number-reused-in-history", __doc__)
_KINDS = frozenset({Kind.REUSED, Kind.RETYPED, Kind.MEANING})


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each number of a message or enum that had several meanings in history.

    Numbers that the user has accepted with ``--accept`` are left out.
    """
    for owner, number, reuses in reuses_by_number(context, _KINDS):
        yield reported(RULE, context, owner, number, reuses)
