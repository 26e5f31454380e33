"""``roverlink info``: print the contents of a recording."""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.table import Table

from roverlink.console import OK, Subparsers, command

if TYPE_CHECKING:
    from roverlink.runtime.recording.reader import Recording


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = command(commands, "info", "show the contents of a recording", "roverlink info run.mcap")
    parser.add_argument(
        "recording", type=Path, help="an .mcap file: of topics (run.mcap) or of datagrams (run.datagrams.mcap)"
    )
    parser.add_argument("--json", action="store_true", help="print the contents as a JSON object")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print the contents of a recording."""
    from roverlink.runtime.recording.reader import Recording

    facts = _facts(Recording(arguments.recording))
    if arguments.json:
        print(json.dumps(facts, indent=2))
    else:
        _print(facts)
    return OK


def _facts(recording: Recording) -> dict[str, Any]:
    seconds = (recording.end - recording.start) / 1e9
    return {
        "files": [{"path": str(file.path), "bytes": file.path.stat().st_size} for file in recording.files],
        "complete": recording.complete,
        "start_ns": recording.start,
        "end_ns": recording.end,
        "seconds": seconds,
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


def _print(facts: dict[str, Any]) -> None:
    console = Console(highlight=False, markup=False, soft_wrap=True)
    for file in facts["files"]:
        console.print(f"file      {file['path']} ({file['bytes'] / 1e6:.2f} MB)")
    start = time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(facts["start_ns"] / 1e9))
    console.print(f"start     {start}, for {facts['seconds']:.1f} s")
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
