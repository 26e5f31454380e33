"""``roverlink init``: start a project, in an empty folder or from a tree of .proto files."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable
from pathlib import Path

from roverlink.console import FINDINGS, OK, TABLE, UNABLE, Subparsers, command, counted
from roverlink.diagnostic_text import Sources, show, show_error
from roverlink.generator.adopt import Adoption, Wanted, adopt
from roverlink.generator.diagnostics import DiagnosticsError, Severity
from roverlink.generator.emit.writer import Change, write
from roverlink.generator.new_project import NewProject, new_project
from roverlink.progress import progress
from roverlink.runtime.core.errors import SetupError

_EXAMPLE = """\
roverlink init
         roverlink init --from proto --envelope components/common/envelope.proto --message PBEnvelope"""
_IN_TOP_FOLDER = (".github/workflows/roverlink.yml", ".pre-commit-config.yaml")


def add(commands: Subparsers) -> None:
    """Declare the command."""
    parser = command(
        commands,
        "init",
        "start a project here, with one board and one message, or with the .proto files that there are",
        _EXAMPLE,
        "Start a project in this folder: mapping.yaml with one message of one board, its .proto file, a GitHub\n"
        "workflow, a pre-commit hook and .gitignore; and generate. With --from, take over a tree of .proto files:\n"
        "draft mapping.yaml from it, with a row for each member of the envelope's oneof, and generate. What had to\n"
        "be guessed is marked. Files that cannot be compiled with the rest are left out, numbers that were used in\n"
        "git's history are retired. Nothing that is there is overwritten, but for the envelope's file where it\n"
        "holds the oneof and nothing else.",
    )
    parser.add_argument(
        "--from", dest="root", type=Path, metavar="PROTO_ROOT", help="take over the .proto files of this folder"
    )
    parser.add_argument("--envelope", default="", metavar="FILE", help="with --from: the envelope's file, below it")
    parser.add_argument(
        "--message", default="", metavar="NAME", help="with --from: the envelope (default: who has the largest oneof)"
    )
    parser.add_argument(
        "--oneof", default="", metavar="NAME", help="with --from: the oneof of the payloads (default: the largest)"
    )
    parser.add_argument(
        "--package", default="comms", metavar="NAME", help="the ROS 2 package to be made (default: %(default)s)"
    )
    parser.add_argument("--dry-run", action="store_true", help="print the mapping.yaml, and write nothing")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Make the files and write them in one go; where that cannot be, nothing is written."""
    table = Path(TABLE)
    if table.exists():
        raise SetupError(f"{table} is there already; `roverlink add` adds a row to it")
    if arguments.root is None and any((arguments.envelope, arguments.message, arguments.oneof)):
        raise SetupError("--envelope, --message and --oneof are about the .proto files that --from names")
    try:
        if arguments.root is None:
            started = new_project(Path.cwd(), arguments.package)
            if _write(started.changes, arguments.dry_run):
                _tell_started(started)
            return OK
        wanted = Wanted(arguments.root, arguments.envelope, arguments.message, arguments.oneof, arguments.package)
        with progress("reading history") as report:
            adoption = adopt(table, wanted, report)
        if _write(adoption.changes, arguments.dry_run):
            _tell(adoption)
    except DiagnosticsError as error:
        show_error(error, Path.cwd(), sys.stderr)
        print("nothing was written", file=sys.stderr)
        return UNABLE if any(one.severity is Severity.FATAL for one in error.findings) else FINDINGS
    return OK


def _write(changes: Iterable[Change], dry_run: bool) -> bool:
    """Write the files, or print the table alone; return whether they were written."""
    if dry_run:
        sys.stdout.writelines(change.after or "" for change in changes if change.path == TABLE)
    else:
        write(Path.cwd(), changes)
    return not dry_run


def _tell_started(started: NewProject) -> None:
    """Say what is there now, and what comes next."""
    for path in started.kept:
        print(f"kept {path}, which was there already")
    own = [change.path for change in started.changes if not change.path.startswith("generated/")]
    print(f"wrote {', '.join(own)} and {len(started.changes) - len(own)} files in generated/")
    here = Path.cwd()
    top = next((folder for folder in (here, *here.parents) if (folder / ".git").exists()), here)
    if top != here:
        print(f"GitHub and pre-commit look for {' and '.join(_IN_TOP_FOLDER)} in the top folder of the repository:")
        print(f"move them to {top}, and let their commands run in {here.relative_to(top)}")
    print("next:")
    print("  roverlink run                                        the bridge, until Ctrl-C")
    print("  roverlink echo board_status                          in a second terminal: what comes to the topic")
    print("  roverlink send board_status battery_voltage=11.7     in a third one: a datagram, as the board sends it")


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
