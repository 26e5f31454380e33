"""A number stood for different things in the course of history.

Tools that compare two states see nothing of it: the number was deleted in one commit and given to something else a few
commits later, or on another branch. Boards, basestations and rovers that were built from the different commits misread
each other without any error.

Bad::

    message PBEnvelope { oneof payload { Foo foo = 18; } }   // in March
    message PBEnvelope { oneof payload { } }                 // in April
    message PBEnvelope { oneof payload { Bar bar = 18; } }   // in May

Good::

    message PBEnvelope { oneof payload { Bar bar = 22; } reserved 18; reserved "foo"; }

The past cannot be undone: `roverlink lint --history --accept` writes what was found into the ledger, so that the
numbers are never given away again, and only what is new is found from then on.
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
    """Numbers of messages and enums with more than one meaning, but for those that were accepted."""
    for owner, number, reuses in reuses_by_number(context, _KINDS):
        yield reported(RULE, context, owner, number, reuses)
