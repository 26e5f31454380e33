"""Write all files that depend on mapping.yaml: Python handlers, ROS 2 messages, envelope, docs.

Read mapping.yaml and the .proto files, and write all files that are made from them: the Python handlers
that convert messages, the envelope's .proto file, a ROS 2 package with .msg files, mapping.lock, and
docs. Run it after each change of mapping.yaml or of a .proto file. The output lists the changed files.
If there is an error in mapping.yaml or in a .proto file that a row needs, the command prints it and
writes nothing (exit code 1); `roverlink lint` checks all other .proto files, too. A file that roverlink
did not generate is never replaced, unless you give --overwrite.

Example: roverlink generate --check
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from roverlink.console import (
    FINDINGS,
    OK,
    UNABLE,
    Subparsers,
    add_table,
    counted,
    documented_command,
    print_note,
    table_file,
)
from roverlink.diagnostic_text import Sources, show_error, show_without_hints
from roverlink.generator.diagnostics import DiagnosticsError, Severity
from roverlink.generator.emit import targets
from roverlink.generator.emit.writer import Change, write
from roverlink.generator.pipeline import Compiled, compile_table
from roverlink.generator.source_files import visible
from roverlink.runtime.core.errors import SetupError, nearest


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    add_table(parser)
    parser.add_argument(
        "--check",
        action="store_true",
        help="write nothing; if a file is not up to date, print the difference and exit with code 1",
    )
    parser.add_argument(
        "--overwrite",
        action="store_true",
        help="replace files that have the path of a generated file, but were not generated",
    )
    parser.add_argument(
        "--target",
        action="append",
        default=[],
        metavar="NAME",
        help="write this kind of output too: cpp (C++ handlers), jsonschema, nanopb (.options files); may be repeated; "
        "the next run without this option removes the files, so list the target under `targets` in mapping.yaml to "
        "keep them",
    )
    parser.add_argument(
        "--template",
        action="append",
        default=[],
        type=Path,
        metavar="DIR",
        help="also render your own Jinja templates in the folder DIR, into generated/DIR; may be repeated; as with "
        "--target, `templates` in mapping.yaml keeps the files",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Write the generated files, or with ``--check`` only check if they are up to date.

    The exit code is 1 if there are diagnostics, or if ``--check`` finds a file that is out of date.
    """
    known = targets.names()
    if unknown := next((name for name in arguments.target if name not in known), None):
        raise SetupError(f"--target: unknown target {unknown!r}; {nearest(unknown, known)}")
    table = table_file(arguments.table)
    try:
        # Relative to the table: generated files name their templates and must not contain machine paths.
        folders = [os.path.relpath(folder, table.resolve().parent) for folder in arguments.template]
        compiled = compile_table(table, arguments.target, folders)
        changes = compiled.changes(table.resolve().parent)
        show_without_hints(compiled.warnings, Sources(table.parent), sys.stderr)
        if arguments.check:
            return _check(table, changes)
        write(table.resolve().parent, changes, arguments.overwrite)
    except DiagnosticsError as error:
        return report(table, error)
    print_changes(compiled, changes)
    return OK


def print_changes(compiled: Compiled, changes: list[Change]) -> None:
    """Print one line for each changed file, then the number of changed files, of generated files and of messages."""
    for change in changes:
        print(f"{change.verb:>8} {change.path}")
    said = counted(len(changes), "change"), counted(len(compiled.bridge.routes), "message")
    print(f"{said[0]} in {len(compiled.files)} files for {said[1]}")


def _check(table: Path, changes: list[Change]) -> int:
    for change in changes:
        sys.stdout.write(visible(change.diff()))
    if changes:
        print_note(f"{counted(len(changes), 'file')} out of date with {table}; run `roverlink generate`")
        return FINDINGS
    print(f"all files are up to date with {table}")
    return OK


def report(table: Path, error: DiagnosticsError) -> int:
    """Print the diagnostics of an error because of which no file was written, and return the exit code."""
    severities = [finding.severity for finding in error.findings]
    errors = sum(severity.rank <= Severity.ERROR.rank for severity in severities)
    show_error(error, table.parent)
    print_note(f"{counted(errors, 'error')}; nothing was written")
    return UNABLE if Severity.FATAL in severities else FINDINGS
