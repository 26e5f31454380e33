"""``roverlink init``: take over a tree of .proto files."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from generator.adopt import Adoption, Wanted, adopt
from generator.diagnostics import DiagnosticsError, Severity
from generator.write import write
from roverlink.console import FINDINGS, OK, TABLE, UNABLE, Subparsers, command, counted
from roverlink.diagnostic_text import Sources, show, show_error
from roverlink.progress import progress
from runtime.errors import SetupError


def add(commands: Subparsers) -> None:
    """Declare the command."""
    parser = command(
        commands,
        "init",
        "take over a tree of .proto files: draft mapping.yaml from it, and generate",
        "roverlink init --from proto --envelope components/common/envelope.proto --message PBEnvelope",
        "Take over a tree of .proto files: draft a mapping.yaml in this folder, with a row for each member of the\n"
        "envelope's oneof, and generate. What had to be guessed is marked. Files that cannot be compiled with the\n"
        "rest are left out, numbers that were used in git's history are retired. Nothing that is there is\n"
        "overwritten, but for the envelope's file where it holds the oneof and nothing else.",
    )
    parser.add_argument(
        "--from", dest="root", type=Path, required=True, metavar="PROTO_ROOT", help="the folder that imports start from"
    )
    parser.add_argument("--envelope", default="", metavar="FILE", help="the envelope's file, below PROTO_ROOT")
    parser.add_argument(
        "--message", default="", metavar="NAME", help="the envelope (default: who has the largest oneof)"
    )
    parser.add_argument("--oneof", default="", metavar="NAME", help="the oneof of the payloads (default: the largest)")
    parser.add_argument(
        "--package", default="comms", metavar="NAME", help="the ROS 2 package to be made (default: %(default)s)"
    )
    parser.add_argument("--dry-run", action="store_true", help="print the mapping.yaml, and write nothing")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Draft and generate in one go; where either cannot be, nothing is written."""
    table = Path(TABLE)
    if table.exists():
        raise SetupError(f"{table} is there already; `roverlink add` adds a row to it")
    wanted = Wanted(arguments.root, arguments.envelope, arguments.message, arguments.oneof, arguments.package)
    try:
        with progress("reading history") as report:
            adoption = adopt(table, wanted, report)
        if arguments.dry_run:
            text = next(change.after for change in adoption.changes if change.path == TABLE)
            sys.stdout.write(text or "")
            return OK
        write(Path.cwd(), adoption.changes)
    except DiagnosticsError as error:
        show_error(error, Path.cwd(), sys.stderr)
        print("nothing was written", file=sys.stderr)
        return UNABLE if any(one.severity is Severity.FATAL for one in error.findings) else FINDINGS
    _tell(adoption)
    return OK


def _tell(adoption: Adoption) -> None:
    """Say what was found, what was guessed, and what comes next."""
    draft = adoption.draft
    guessed = sum(bool(row.doubt) for row in draft.rows)
    print(f"{draft.message} in {draft.root}/{draft.file} has {counted(len(draft.rows), 'payload')} in {draft.oneof}")
    print(f"  {draft.owner_reason}")
    for row in draft.rows:
        print(f"  {row.number:>5} {row.name:<28} {row.direction:<24}{'  guessed' if row.doubt else ''}".rstrip())
    for file, why in draft.exclude.items():
        print(f"left out: {file}: {why}")
    for row in draft.rows:
        for path, why in row.ignore.items():
            print(f"not carried: {path} of {row.name}: {why}")
    for field in adoption.scalars:
        print(f"not carried: {field} in {draft.oneof}, which is no message")
    for gone in draft.retired:
        print(f"retired: {gone.number} {gone.name} ({gone.proto}){f': {gone.note}' if gone.note else ''}")
    if adoption.past.reused:
        numbers = ", ".join(map(str, adoption.past.reused))
        print(f"numbers that stood for something else before: {numbers}; see `roverlink lint --history`")
    _tell_findings(adoption)
    added = sum(change.verb == "added" for change in adoption.changes)
    changed = [change.path for change in adoption.changes if change.verb != "added"]
    print(f"wrote {TABLE} and {added - 1} generated files" + "".join(f"; changed {path}" for path in changed))
    print("next:")
    print(f"  look at {TABLE}: {counted(guessed, 'direction')} and the peers' ports are guessed")
    print("  roverlink generate    after each change of it")
    print("  roverlink lint        what is wrong with numbers and names")
    print("  roverlink run         the bridge")


def _tell_findings(adoption: Adoption) -> None:
    show(adoption.findings, Sources(Path.cwd()), sys.stdout)
    draft = adoption.draft
    if lowered := sorted({*draft.lint, *(rule for row in draft.rows for rule in row.lint)}):
        print(f"{', '.join(lowered)}: a hint for now, under `lint` in {TABLE}; remove that once it is mended,")
        print(f"or keep it with your reason; `roverlink explain {lowered[0]}` says what it is about")
