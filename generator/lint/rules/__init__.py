"""The rules of the lint: pure functions from the context to diagnostics.

Rules do not import each other. A module in this folder is found without being registered anywhere.
"""

from __future__ import annotations

import importlib
import pkgutil
from abc import abstractmethod
from collections.abc import Iterator, Mapping
from functools import cache

from roverlink.generator.diagnostics import Diagnostic, Rule, rules_in
from roverlink.generator.lint.context import Context


class LintRule(Rule, id=""):
    """Base of the rules of the lint. Each is a subclass whose docstring is the rule's documentation (see `Rule`)."""

    @classmethod
    @abstractmethod
    def check(cls, context: Context) -> Iterator[Diagnostic]:
        """Yield the diagnostics of the rule. The engine calls this once for each context."""


@cache
def lint_rules() -> Mapping[str, type[LintRule]]:
    """Return each rule of the lint, by its id."""
    modules = [importlib.import_module(f"{__name__}.{found.name}") for found in pkgutil.iter_modules(__path__)]
    found = [rule for module in modules for rule in rules_in(module).values() if issubclass(rule, LintRule)]
    return {rule.id: rule for rule in sorted(found, key=lambda rule: rule.id)}
