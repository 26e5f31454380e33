"""``roverlink generate``: compile the table."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import generator
from generator import FindingsError, Severity
from roverlink.console import FINDINGS, OK, UNABLE, Subparsers, add_table, command, table_file


def add(commands: Subparsers) -> None:
    """Declare the command."""
    parser = command(
        commands,
        "generate",
        "compile mapping.yaml into handlers, messages, registry, envelope, ROS 2 package and docs",
        "roverlink generate --check",
    )
    add_table(parser)
    parser.add_argument(
        "--check", action="store_true", help="write nothing; exit 1 with a diff where a file is not what the table says"
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Generate, or check; exit code 1 for findings and for drift."""
    table = table_file(arguments.table)
    try:
        compiled = generator.compile_table(table)
        changes = generator.compare(table.resolve().parent, compiled.files, compiled.folders)
        for warning in compiled.warnings:
            print(warning.render(), file=sys.stderr)
        if arguments.check:
            return _check(table, changes)
        generator.write(table.resolve().parent, changes)
    except FindingsError as error:
        return _report(table, error)
    for change in changes:
        print(f"{change.verb:>8} {change.path}")
    messages = len(compiled.bridge.routes)
    plural = "s" if len(changes) != 1 else ""
    print(f"{len(changes)} change{plural} in {len(compiled.files)} files for {messages} messages")
    return OK


def _check(table: Path, changes: list[generator.Change]) -> int:
    for change in changes:
        sys.stdout.write(change.diff())
    if changes:
        print(f"{len(changes)} of the files differ from what {table} says; run `roverlink generate`", file=sys.stderr)
        return FINDINGS
    print(f"everything is what {table} says")
    return OK


def _report(table: Path, error: FindingsError) -> int:
    severities = [finding.rule.severity for finding in error.findings]
    errors = len(severities) - severities.count(Severity.WARNING)
    print(error, file=sys.stderr)
    print(f"{errors} error{'s' if errors != 1 else ''} in {table}; nothing was written", file=sys.stderr)
    return UNABLE if Severity.FATAL in severities else FINDINGS
