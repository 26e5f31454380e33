"""List of all rules: the rules of the lint, and the rules of other steps about input that these steps cannot use."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from types import ModuleType

from roverlink.generator import init_rules
from roverlink.generator.diagnostics import Rule, rules_in
from roverlink.generator.emit import output_rules
from roverlink.generator.emit.targets.cpp import unsupported_names
from roverlink.generator.lint import buf, input_rules
from roverlink.generator.lint.rules import lint_rules
from roverlink.generator.lock import ledger_rules
from roverlink.generator.nanopb import option_rules
from roverlink.generator.protos import proto_rules
from roverlink.generator.resolve import conversion_rules, safety_rules
from roverlink.generator.resolve.standard import standard_rules
from roverlink.generator.table import edit_rules, reading_rules

DECLARED_IN: Mapping[str, ModuleType] = {
    "ADO": init_rules,
    "BUF": buf,
    "CNV": conversion_rules,
    "CPP": unsupported_names,
    "LED": ledger_rules,
    "MAP": reading_rules,
    "NPB": option_rules,
    "OUT": output_rules,
    "PIN": input_rules,
    "PRO": proto_rules,
    "RET": edit_rules,
    "SAF": safety_rules,
    "STA": input_rules,
    "STD": standard_rules,
}
"""Modules that declare the rules outside of `lint/rules/`, by the letters that start their ids: `MAP` for `MAP101`.

The modules in `lint/rules/` declare the rules of the lint.
"""


@cache
def rules() -> Mapping[str, type[Rule]]:
    """Return every rule that can raise a diagnostic, by the rule's id, such as ``ENV101``."""
    found: dict[str, type[Rule]] = dict(lint_rules())
    for module in DECLARED_IN.values():
        found |= rules_in(module)
    return dict(sorted(found.items()))
