"""Show the files, the duration and the topics of a recording.

Show the contents of a recording of `roverlink record`: its files, its start and duration, the fingerprint
(a hash) of the table with which it was made, and for each topic its message type, the number of messages
and the messages a second. If the recorder was killed or is still running, a line says that the recording
is incomplete. If the computer's clock was set during the recording, lines say when and by how much; the
start and the duration do not depend on that.

Example: roverlink recording info run.mcap
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from roverlink.console import OK, Subparsers, documented_command

if TYPE_CHECKING:
    from roverlink.runtime.recording.clocks import ClockJump
    from roverlink.runtime.recording.reader import Recording


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    parser.add_argument(
        "recording", type=Path, help="an .mcap file: of topics (run.mcap) or of datagrams (run.datagrams.mcap)"
    )
    parser.add_argument("--json", action="store_true", help="print the contents as a JSON object")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print the contents of a recording as text, or with ``--json`` as a JSON object."""
    from roverlink.runtime.recording.reader import Recording

    recording = Recording(arguments.recording)
    facts = _facts(recording)
    if arguments.json:
        print(json.dumps(facts, indent=2))
    else:
        _print(facts, recording.jumps)
    return OK


def _facts(recording: Recording) -> dict[str, Any]:
    seconds = (recording.end - recording.start) / 1e9
    return {
        "files": [{"path": str(file.path), "bytes": file.path.stat().st_size} for file in recording.files],
        "complete": recording.complete,
        "start_ns": recording.start,
        "end_ns": recording.end,
        "seconds": seconds,
        "clock_jumps": [
            {
                "after_seconds": (jump.time - recording.start) / 1e9,
                "by_seconds": jump.by / 1e9,
                "before_ns": jump.before,
                "after_ns": jump.after,
            }
            for jump in recording.jumps
        ],
        "table": recording.metadata,
        "topics": [
            {
                "topic": topic,
                "type": channel.schema_name,
                "encoding": channel.encoding,
                "count": count,
                "rate": count / seconds if seconds else None,
            }
            for topic, (channel, count) in sorted(recording.channels().items())
        ],
    }


def _print(facts: dict[str, Any], jumps: list[ClockJump]) -> None:
    from rich.console import Console  # here: --help needs no rich
    from rich.table import Table

    from roverlink.runtime.recording.clocks import local_time

    console = Console(highlight=False, markup=False, soft_wrap=True)
    for file in facts["files"]:
        console.print(f"file      {file['path']} ({file['bytes'] / 1e6:.2f} MB)")
    console.print(f"start     {local_time(facts['start_ns'])}, for {facts['seconds']:.1f} s")
    for jump in jumps:
        console.print(f"clock     {jump.text(facts['start_ns'])}")
    if "fingerprint" in facts["table"]:
        console.print(f"table     {facts['table']['fingerprint']}")
    if not facts["complete"]:
        console.print("state     incomplete: the recorder was killed or is still running")
    table = Table(box=None, pad_edge=False)
    for name in ("topic", "type"):
        table.add_column(name, no_wrap=True)
    for name in ("count", "rate"):
        table.add_column(name, justify="right", no_wrap=True)
    for topic in facts["topics"]:
        if topic["count"]:
            rate = f"{topic['rate']:.1f}/s" if topic["rate"] is not None else ""
            table.add_row(topic["topic"], topic["type"] or "raw bytes", str(topic["count"]), rate)
    console.print(table)
