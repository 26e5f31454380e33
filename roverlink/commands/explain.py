"""``roverlink explain``: what a rule of the lint is about."""

from __future__ import annotations

import argparse

from generator.rules import modules
from roverlink.console import OK, Subparsers, command
from runtime.errors import SetupError, nearest


def add(commands: Subparsers) -> None:
    """Declare the command."""
    parser = command(
        commands,
        "explain",
        "say what a rule of the lint finds, why that hurts, and what to write instead",
        "roverlink explain ENV101",
    )
    parser.add_argument("rule", nargs="?", metavar="ID", help="the rule, as findings name it; all of them without it")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print a rule's documentation, or a line for each rule."""
    rules = modules()
    if arguments.rule is None:
        for id, module in rules.items():
            print(f"{id} {module.RULE.severity.value:<8} {module.RULE.name}")
        return OK
    by_name = {module.RULE.name: module for module in rules.values()}
    found = rules.get(arguments.rule.upper()) or by_name.get(arguments.rule)
    if found is None:
        hint = nearest(arguments.rule, [*rules, *by_name])
        raise SetupError(f"the lint has no rule {arguments.rule!r}; {hint}. docs/mapping.md lists all other findings")
    print(f"{found.RULE.id} {found.RULE.name} ({found.RULE.severity.value})\n\n{found.__doc__.strip()}")
    return OK
