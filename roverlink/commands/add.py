"""Add a row to mapping.yaml with the next unused number, and run generate.

Add a row to mapping.yaml, so that the bridge converts a message that you have declared in a .proto file,
and run `roverlink generate`. The comments and the layout of mapping.yaml do not change.

The row gets the number that `roverlink number next` prints. If another repository owns the envelope
(`owner: proto`), the row gets the number that this payload has in that envelope. The output lists the
changed files and the number.

Example: roverlink add container_info --proto ContainerBoardInfo --direction hardware_to_ros
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from roverlink.commands.generate import print_changes, report
from roverlink.commands.number.next import print_skipped
from roverlink.console import OK, Subparsers, add_table, documented_command, print_note, table_file
from roverlink.generator.diagnostics import DiagnosticsError
from roverlink.generator.emit.writer import write
from roverlink.generator.lint.context import Context
from roverlink.generator.lint.project import Question, lint_project
from roverlink.generator.pipeline import add as add_row
from roverlink.lint_scope import in_repository
from roverlink.progress import progress


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    parser.add_argument("name", metavar="NAME", help="name of the payload in the envelope's oneof")
    parser.add_argument(
        "--proto",
        required=True,
        metavar="MESSAGE",
        help="full name of the protobuf message, with its package if it has one, such as rover.ContainerInfo",
    )
    parser.add_argument(
        "--direction",
        required=True,
        metavar="D",
        help="<peer>_to_ros or ros_to_<peer>, where <peer> is a name under `peers` in mapping.yaml",
    )
    parser.add_argument("--topic", metavar="TOPIC", help="name of the ROS 2 topic (default: NAME)")
    parser.add_argument(
        "--ros", metavar="NAME", help="name of the ROS 2 message (default: the name of the protobuf message)"
    )
    parser.add_argument("--dry-run", action="store_true", help="print the changes as a diff without writing them")
    add_table(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Add the row to the table, and generate the code. If the new table does not compile, nothing is written."""
    table = table_file(arguments.table)
    try:
        number = _number(table, arguments.name)
        row: dict[str, str | int] = {"number": number, "name": arguments.name, "proto": arguments.proto}
        row |= {"ros": arguments.ros} if arguments.ros else {}
        row |= {"topic": arguments.topic or arguments.name, "direction": arguments.direction}
        compiled, changes = add_row(table, row)
        if not arguments.dry_run:
            write(table.resolve().parent, changes)
    except DiagnosticsError as error:
        return report(table, error)
    if arguments.dry_run:
        sys.stdout.writelines(change.diff() for change in changes)
    else:
        print_changes(changes, len(compiled.files), len(compiled.bridge.routes))
    print_note(f"{arguments.name} {'would have' if arguments.dry_run else 'has'} the number {number}")
    return OK


def _number(table: Path, name: str) -> int:
    """Return the envelope number for the new row ``name``.

    If another repository owns the envelope, it is the payload's number in that envelope. Otherwise it is the next
    unused number.
    """
    with progress("reading history") as reading:
        question = Question(branches=in_repository(table.resolve().parent), report=reading)
        context = lint_project(table, question).context
    if (member := _member(context, name)) is not None:
        return member
    print_skipped(context)
    return context.next_number()


def _member(context: Context, name: str) -> int | None:
    settings = context.table.envelope
    envelope = context.schema.messages.get(settings.message)
    if envelope is None or settings.owner != "proto":
        return None
    return next((field.number for field in envelope.fields if field.name == name), None)
