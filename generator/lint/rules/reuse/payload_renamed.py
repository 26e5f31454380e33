"""A payload of the envelope was renamed in history, and its content stayed the same.

Bytes do not carry names, so nothing is misread. But a search of the history for one name does not find the other.

Bad::

    Imu imu = 13;       // until May
    ImuInfo imu = 13;   // since then, with the same fields

Good::

    Imu imu = 13;
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.history import Kind
from roverlink.generator.lint.history_diagnostics import reported, reuses_by_number

RULE = Rule("HIS102", "payload-renamed", __doc__, Severity.HINT)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each number of the envelope whose payload was renamed.

    Numbers that another rule reports are left out.
    """
    worse = {(owner.id, number) for owner, number, _ in reuses_by_number(context, frozenset(Kind) - {Kind.RENAMED})}
    for owner, number, reuses in reuses_by_number(context, frozenset({Kind.RENAMED})):
        if owner.name == context.table.envelope.message and (owner.id, number) not in worse:
            yield reported(RULE, context, owner, number, reuses)
