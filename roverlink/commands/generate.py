"""Write all files that depend on mapping.yaml: Python handlers, ROS 2 messages, envelope, docs.

Read mapping.yaml and the .proto files, and write all files that are made from them: the Python handlers
that convert messages, the envelope's .proto file, a ROS 2 package with .msg files, mapping.lock, and
docs. Run it after each change of mapping.yaml or of a .proto file. The output lists the changed files.
If there is an error in mapping.yaml or in a .proto file that a row needs, the command prints it and
writes nothing (exit code 1). Other .proto files that do not compile are warnings. A file that roverlink
did not generate is never replaced, unless you give --overwrite.

Example: roverlink generate --check
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from roverlink.console import FINDINGS, OK, UNABLE, Subparsers, add_table, documented_command, print_note, table_file
from roverlink.diagnostic_text import Sources, show_error, show_without_hints
from roverlink.generator.diagnostics import DiagnosticsError, Severity
from roverlink.generator.emit.writer import Change, compare, write
from roverlink.generator.known_results import KnownResult
from roverlink.generator.source_files import visible
from roverlink.numerals import counted
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
    parser.add_argument(
        "--vendor-runtime",
        action="store_true",
        help="put the part of roverlink that runs a bridge, and the generated Python code, into the ROS 2 package, so "
        "that its folder can be built in any workspace; as with --target, `vendor_runtime` under `ros` in mapping.yaml "
        "keeps the files",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Write the generated files, or with ``--check`` only check if they are up to date.

    The exit code is 1 if there are diagnostics, or if ``--check`` finds a file that is out of date.
    """
    if arguments.target:
        from roverlink.generator.emit import targets  # here: it is slow to import

        names = targets.names()
        if unknown := next((name for name in arguments.target if name not in names), None):
            raise SetupError(f"--target: unknown target {unknown!r}; {nearest(unknown, names)}")
    table = table_file(arguments.table)
    try:
        changes, files, messages = _changes(table, arguments)
        if arguments.check:
            return _check(table, changes)
        write(table.resolve().parent, changes, arguments.overwrite)
    except DiagnosticsError as error:
        return report(table, error)
    print_changes(changes, files, messages)
    return OK


def _changes(table: Path, arguments: argparse.Namespace) -> tuple[list[Change], int, int]:
    """Return the changes of all files on disk, and the numbers of generated files and of messages.

    Warnings are printed. The table is compiled only if its last run had other inputs.
    """
    project = table.resolve().parent
    options = arguments.target or arguments.template or arguments.vendor_runtime
    known = None if options else KnownResult(table, "generate")
    if known and known.value:
        files, folders, own, messages = known.value
        return compare(project, files, folders, own), len(files), messages
    from roverlink.generator.pipeline import compile_table  # here: it is slow to import

    # Relative to the table: generated files name their templates and must not contain machine paths.
    templates = [os.path.relpath(folder, project) for folder in arguments.template]
    compiled = compile_table(table, arguments.target, templates, vendor_runtime=arguments.vendor_runtime)
    changes, messages = compiled.changes(project), len(compiled.bridge.routes)
    show_without_hints(compiled.warnings, Sources(table.parent), sys.stderr)
    # Some generated files are inputs, too, such as the ledger. So a run that changes files is followed by another one.
    if known and compiled.repeatable and not changes and not compiled.warnings:
        known.save(compiled.root, (compiled.files, dict(compiled.folders), compiled.own, messages))
    return changes, len(compiled.files), messages


def print_changes(changes: list[Change], files: int, messages: int) -> None:
    """Print one line for each changed file, then the number of changed files, of generated files and of messages."""
    for change in changes:
        print(f"{change.verb:>8} {change.path}")
    print(f"{counted(len(changes), 'change')} in {counted(files, 'file')} for {counted(messages, 'message')}")


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
