"""Rule about the `lint` sections of the table."""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Severity, Span
from roverlink.generator.lint import buf
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.rules import LintRule, lint_rules
from roverlink.generator.table import Lowered


class LintSettingWithoutEffect(LintRule, id="TAB108", severity=Severity.WARNING):
    """A setting under `lint` has no effect.

    The setting names an unknown rule, a rule that cannot be lowered, or a severity that is not lower than that of the
    rule. The author of the setting expects that it changes what the lint reports, but it does not.

    Bad::

        lint:
          ENV601: {severity: warning, reason: the sequence number of the old firmware}  # there is no such rule
          TAB107: {severity: warning, reason: we rename topics now and then}  # it is a warning anyway

    Good::

        lint:
          ENV106: {severity: warning, reason: the sequence number of the old firmware}
          TAB107: {severity: hint, reason: we rename topics now and then}
    """

    @classmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield a diagnostic for each setting under `lint` that changes no severity, in the table and in its rows."""
        table = context.table
        for lowered in table.lint:
            yield from (cls.at(*fault) for fault in _faults(lowered))
        for row in table.rows:
            for fault in (fault for lowered in row.lint for fault in _faults(lowered)):
                yield cls.of_row(table, row, *fault)


def _faults(lowered: Lowered) -> Iterator[tuple[Span, str, str]]:
    """Yield the place, the message and the help for a setting without effect."""
    rule = lint_rules().get(lowered.rule) or buf.rule(lowered.rule)
    if rule is None:
        message = f"the lint has no rule {lowered.rule!r}"
        yield lowered.span, message, "run `roverlink explain` for a list of the rules"
    elif rule.severity is Severity.FATAL:
        message = f"{rule.id} ({rule.name}) is fatal, so its severity cannot be lowered"
        yield lowered.span, message, "remove this setting"
    elif lowered.severity != "off" and Severity(lowered.severity).rank <= rule.severity.rank:
        message = f"{rule.id} ({rule.name}) has severity {rule.severity.value}; {lowered.severity!r} is not lower"
        yield lowered.at("severity"), message, "write a lower severity, or remove this setting"
