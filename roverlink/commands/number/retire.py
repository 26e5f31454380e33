"""Retire an envelope number, so that it is never used again.

Retire an envelope number whose payload is no longer needed, so that no other payload ever gets this number:
old firmware and old recordings may still contain it. The command moves the row in mapping.yaml from
`messages` to `retired`, and runs `roverlink generate`, which reserves the number in the envelope. The
output lists the changed files.

Example: roverlink number retire 14
"""

from __future__ import annotations

import argparse

from roverlink.commands.generate import print_changes, report
from roverlink.completion import complete, numbers, rows
from roverlink.console import OK, Subparsers, add_table, documented_command, table_file
from roverlink.generator.diagnostics import DiagnosticsError
from roverlink.generator.emit.writer import write
from roverlink.generator.pipeline import retire


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    row = parser.add_argument("row", metavar="NUMBER|ROW", help="number of the payload in the envelope, or its row")
    complete(row, numbers, rows)
    add_table(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Retire the number of a row, and generate the code. If the table then does not compile, nothing is written."""
    table = table_file(arguments.table)
    try:
        compiled, changes = retire(table, arguments.row)
        write(table.resolve().parent, changes)
    except DiagnosticsError as error:
        return report(table, error)
    print_changes(changes, len(compiled.files), len(compiled.bridge.routes))
    return OK
