"""All rules: those of the lint, and those of every phase that can refuse its input."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from types import ModuleType

from generator import (
    buf,
    conversion_rules,
    edit_rules,
    guard_rules,
    output_rules,
    proto_rules,
    state_rules,
    table_rules,
)
from generator.adopt import faults as adopt_faults
from generator.diagnostics import Rule
from generator.feeds import faults as feed_faults
from generator.ledger import faults as ledger_faults
from generator.nanopb import option_rules
from generator.rules import modules
from generator.targets.cpp import faults as cpp_faults

_DECLARED_IN: tuple[ModuleType, ...] = (
    table_rules,
    proto_rules,
    conversion_rules,
    guard_rules,
    feed_faults,
    option_rules,
    buf,
    cpp_faults,
    output_rules,
    ledger_faults,
    edit_rules,
    state_rules,
    adopt_faults,
)


@cache
def rules() -> Mapping[str, Rule]:
    """Return every rule that can raise a diagnostic, by its id."""
    found = [value for module in _DECLARED_IN for value in vars(module).values() if isinstance(value, Rule)]
    found += [module.RULE for module in modules().values()]
    return {rule.id: rule for rule in sorted(found, key=lambda rule: rule.id)}
