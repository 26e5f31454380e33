"""A setting under `lint` has no effect.

The setting names an unknown rule, a rule that cannot be lowered, or a severity that is not lower than that of the rule.
The author of the setting expects that it changes what the lint reports, but it does not.

Bad::

    lint:
      ENV601: {severity: warning, reason: the sequence number of the old firmware}  # there is no such rule
      TAB107: {severity: warning, reason: we rename topics now and then}  # it is a warning anyway

Good::

    lint:
      ENV106: {severity: warning, reason: the sequence number of the old firmware}
      TAB107: {severity: hint, reason: we rename topics now and then}
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator, Mapping
from functools import cache

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity
from roverlink.generator.lint import buf
from roverlink.generator.lint.context import Context
from roverlink.generator.table import Lowered

RULE = Rule("TAB108", "lint-setting-without-effect", __doc__, Severity.WARNING)


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each setting under `lint` that changes no severity, in the table and in its rows."""
    table = context.table
    for lowered in table.lint:
        yield from _check(lowered, "", None)
    for row in table.rows:
        for lowered in row.lint:
            yield from _check(lowered, table.envelope.message, row.number)


def _check(lowered: Lowered, type: str, number: int | None) -> Iterator[Diagnostic]:
    rule = _rules().get(lowered.rule) or buf.rule(lowered.rule)
    if rule is None:
        message = f"the lint has no rule {lowered.rule!r}"
        yield RULE.at(
            lowered.span, message, "run `roverlink explain` for a list of the rules", type=type, number=number
        )
    elif rule.severity is Severity.FATAL:
        message = f"{rule.id} ({rule.name}) is fatal, so its severity cannot be lowered"
        yield RULE.at(lowered.span, message, "remove this setting", type=type, number=number)
    elif lowered.severity != "off" and Severity(lowered.severity).rank <= rule.severity.rank:
        message = f"{rule.id} ({rule.name}) has severity {rule.severity.value}; {lowered.severity!r} is not lower"
        yield RULE.at(
            lowered.at("severity"), message, "write a lower severity, or remove this setting", type=type, number=number
        )


@cache
def _rules() -> Mapping[str, Rule]:
    """Return every rule by its id. The list of rules is imported here, because it imports this module."""
    listed = importlib.import_module("roverlink.generator.lint.rules")
    return {id: module.RULE for id, module in listed.modules().items()}
