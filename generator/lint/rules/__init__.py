"""The rules of the lint: pure functions from the context to diagnostics.

Each rule is a module with `RULE` and `check`, and its docstring is the rule's documentation. Rules do not import each
other. A module in this folder is found without being registered anywhere.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Protocol, cast

from roverlink.generator.diagnostics import Diagnostic, Rule
from roverlink.generator.lint.context import Context


class RuleModule(Protocol):
    """A module that contains a rule of the lint."""

    RULE: Rule

    def check(self, context: Context) -> Iterator[Diagnostic]:
        """Yield the diagnostics of the rule. The engine calls this once for each context."""


@cache
def modules() -> Mapping[str, RuleModule]:
    """Return the module of each rule of the lint, by the rule's id."""
    names = [found.name for found in pkgutil.walk_packages(__path__, f"{__name__}.") if not found.ispkg]
    loaded = [cast(RuleModule, importlib.import_module(name)) for name in names]
    return {module.RULE.id: module for module in sorted(loaded, key=lambda module: module.RULE.id)}
