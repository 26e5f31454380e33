"""The rules: pure functions from the context to diagnostics. One file a rule; none knows another.

Each module has `RULE` and `check`, and its docstring is the rule's documentation. A module that is put into this folder
is a rule of the lint; nothing else has to know it.
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
    """What a module of this folder has."""

    RULE: Rule

    def check(self, context: Context) -> Iterator[Diagnostic]:
        """What the rule finds."""


@cache
def modules() -> Mapping[str, RuleModule]:
    """The rules by their ids."""
    names = [found.name for found in pkgutil.walk_packages(__path__, f"{__name__}.") if not found.ispkg]
    loaded = [cast(RuleModule, importlib.import_module(name)) for name in names]
    return {module.RULE.id: module for module in sorted(loaded, key=lambda module: module.RULE.id)}
