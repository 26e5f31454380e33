"""The rules of the lint: pure functions from the context to diagnostics.

Rules do not import each other. A module in this folder is found without being registered anywhere.
"""

from __future__ import annotations

import importlib
import pkgutil
from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from functools import cache

from roverlink.generator.diagnostics import Diagnostic, Rule, Span, rules_in
from roverlink.generator.lint.context import Context
from roverlink.generator.table import Numbered, RetiredRow, Table


class LintRule(Rule, id=""):
    """Base of the rules of the lint. Each is a subclass whose docstring is the rule's documentation (see `Rule`)."""

    @classmethod
    @abstractmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield the diagnostics of the rule. The engine calls this once for each context."""

    @classmethod
    def of_row(
        cls,
        table: Table,
        row: Numbered | RetiredRow,
        place: str | Span,
        message: str,
        help: str = "",
        also: Sequence[tuple[Span, str]] = (),
        rests_on: Sequence[Span] = (),
    ) -> Diagnostic:
        """Return a diagnostic about a member of the envelope; ``place`` is a place, or a key of the row."""
        span = row.at(place) if isinstance(place, str) else place
        envelope = table.envelope.message
        return cls.at(span, message, help, also, type=envelope, number=row.number, rests_on=rests_on)


@cache
def lint_rules() -> Mapping[str, type[LintRule]]:
    """Return each rule of the lint, by its id."""
    modules = [importlib.import_module(f"{__name__}.{module.name}") for module in pkgutil.iter_modules(__path__)]
    found = [rule for module in modules for rule in rules_in(module).values() if issubclass(rule, LintRule)]
    return {rule.id: rule for rule in sorted(found, key=lambda rule: rule.id)}
