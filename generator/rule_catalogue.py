"""All rules: those of the lint, and those of every phase that can refuse its input."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from types import ModuleType

from roverlink.generator.adopt import adoption_rules as adopt_faults
from roverlink.generator.diagnostics import Rule
from roverlink.generator.emit import output_rules
from roverlink.generator.emit.targets.cpp import unsupported_names as cpp_faults
from roverlink.generator.lint import buf, input_rules
from roverlink.generator.lint.rules import modules
from roverlink.generator.lock import ledger_rules as ledger_faults
from roverlink.generator.nanopb import option_rules
from roverlink.generator.protos import proto_rules
from roverlink.generator.resolve import conversion_rules, safety_rules
from roverlink.generator.resolve.standard import standard_rules as feed_faults
from roverlink.generator.table import edit_rules, table_rules

_DECLARED_IN: tuple[ModuleType, ...] = (
    table_rules,
    proto_rules,
    conversion_rules,
    safety_rules,
    feed_faults,
    option_rules,
    buf,
    cpp_faults,
    output_rules,
    ledger_faults,
    edit_rules,
    input_rules,
    adopt_faults,
)


@cache
def rules() -> Mapping[str, Rule]:
    """Return every rule that can raise a diagnostic, by its id."""
    found = [value for module in _DECLARED_IN for value in vars(module).values() if isinstance(value, Rule)]
    found += [module.RULE for module in modules().values()]
    return {rule.id: rule for rule in sorted(found, key=lambda rule: rule.id)}
