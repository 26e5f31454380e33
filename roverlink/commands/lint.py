"""``roverlink lint``: what is wrong with numbers, names and sizes, now and against another state."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from generator.findings import FindingsError, Severity
from generator.linting import Linted, lint_project, lint_tree
from generator.tree import EnvelopeName
from roverlink.console import FINDINGS, OK, UNABLE, Subparsers, add_table, command, table_file
from roverlink.reports import FORMATS

_COUNTED = ("error", "warning", "hint")


def add(commands: Subparsers) -> None:
    """Declare the command."""
    parser = command(
        commands,
        "lint",
        "find reused numbers and everything else that lets two machines misread each other",
        "roverlink lint --against main",
        "Look at table, protos and ledger, and at every change against another state. Exit code 0: clean;\n"
        "1: findings; 2: something could not be looked at. `roverlink explain ID` says what a rule is about.",
    )
    parser.add_argument(
        "root", nargs="?", type=Path, metavar="PROTO_ROOT", help="a tree of .proto files that has no mapping.yaml"
    )
    add_table(parser)
    parser.add_argument("--against", metavar="STATE", help="a folder, a descriptor set, or a git ref to compare with")
    parser.add_argument("--envelope", default="", metavar="FILE", help="the envelope's file, in a tree without table")
    parser.add_argument("--message", default="", metavar="NAME", help="the envelope's message, in a tree without table")
    parser.add_argument("--format", choices=FORMATS, default="text", help="how to say it (default: %(default)s)")
    parser.add_argument(
        "--fail-on",
        choices=_COUNTED,
        default="warning",
        help="what is severe enough for exit code 1 (default: %(default)s)",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Lint, and say what was found."""
    try:
        linted = _lint(arguments)
    except FindingsError as error:
        print(error, file=sys.stderr)
        return UNABLE
    FORMATS[arguments.format](linted)
    severities = {finding.severity for finding in linted.findings}
    if Severity.FATAL in severities:
        return UNABLE
    limit = Severity(arguments.fail_on).rank
    return FINDINGS if any(severity.rank <= limit for severity in severities) else OK


def _lint(arguments: argparse.Namespace) -> Linted:
    if arguments.root is None:
        return lint_project(table_file(arguments.table), arguments.against)
    return lint_tree(arguments.root, EnvelopeName(arguments.envelope, arguments.message), arguments.against)
