"""``roverlink lint``: what is wrong with numbers, names and sizes: now, against another state, in all of history."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from roverlink.console import FINDINGS, OK, UNABLE, Subparsers, command, table_file
from roverlink.diagnostic_text import show_error
from roverlink.generator.diagnostics import DiagnosticsError, Severity
from roverlink.generator.lint.project import Linted, Question
from roverlink.lint_scope import add_subject, folder_of, linted
from roverlink.progress import progress
from roverlink.reports import FORMATS
from roverlink.runtime.core.errors import SetupError

_COUNTED = ("error", "warning", "hint")


def add(commands: Subparsers) -> None:
    """Declare the command."""
    parser = command(
        commands,
        "lint",
        "find reused numbers and everything else that lets two machines misread each other",
        "roverlink lint --against main",
        "Look at table, protos and ledger, at every change against another state, and at all of history. Exit code 0:\n"
        "clean; 1: findings; 2: something could not be looked at. `roverlink explain ID` says what a rule is about.",
    )
    add_subject(parser)
    parser.add_argument("--against", metavar="STATE", help="a folder, a descriptor set, or a git ref to compare with")
    parser.add_argument(
        "--with-buf",
        action="store_true",
        help="with --against: also show what an installed buf finds about generated code and JSON",
    )
    parser.add_argument(
        "--history",
        nargs="?",
        type=Path,
        const=True,
        metavar="REPO",
        help="look at every state in git's history, on all branches; REPO is a tree without mapping.yaml",
    )
    parser.add_argument("--branches", action="store_true", help="find numbers that two open branches have given away")
    parser.add_argument(
        "--pins",
        nargs="+",
        type=Path,
        default=[],
        metavar="FILE|REPO",
        help="compare the commits that consumers are pinned to: submodules, CMake's GIT_TAG, or lines `name commit`",
    )
    parser.add_argument(
        "--accept", action="store_true", help="with --history: take note of what was found, in the ledger, for good"
    )
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
        found = _lint(arguments)
        if arguments.accept:
            return _accept(arguments, found)
    except DiagnosticsError as error:
        show_error(error, folder_of(arguments), sys.stderr)
        return UNABLE
    FORMATS[arguments.format](found)
    severities = {finding.severity for finding in found.findings}
    if Severity.FATAL in severities:
        return UNABLE
    limit = Severity(arguments.fail_on).rank
    return FINDINGS if any(severity.rank <= limit for severity in severities) else OK


def _lint(arguments: argparse.Namespace) -> Linted:
    of_history: Path | None = arguments.history if isinstance(arguments.history, Path) else None
    if of_history is not None and arguments.root is not None:
        raise SetupError(f"two trees are named, {arguments.root} and {of_history}: one lint looks at one")
    if arguments.with_buf and not arguments.against:
        raise SetupError("--with-buf compares two states: name the other one with --against")
    root = of_history or arguments.root
    with progress("reading history") as report:
        question = Question(
            against=arguments.against,
            with_buf=arguments.with_buf,
            history=arguments.history is not None,
            branches=arguments.branches,
            pins=tuple(arguments.pins),
            report=report,
        )
        return linted(arguments, root, question)


def _accept(arguments: argparse.Namespace, found: Linted) -> int:
    """Burn the numbers that history found, and generate."""
    # Here, since whoever only lints does not need what writes Python.
    from roverlink.generator.accept import accept
    from roverlink.generator.emit.writer import write

    changes, accepted = accept(table_file(arguments.table), found)
    write(found.folder, changes)
    for change in changes:
        print(f"{change.verb:>8} {change.path}")
    print(f"{accepted} numbers of the past are accepted; only what is new is found from now on")
    return OK
