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
import shutil
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from roverlink.console import OK, Subparsers, documented_command

if TYPE_CHECKING:
    from roverlink.runtime.recording.clocks import ClockJump
    from roverlink.runtime.recording.reader import Recording


_GAP = "  "


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
    from roverlink.runtime.recording.clocks import local_time

    for file in facts["files"]:
        print(f"file      {file['path']} ({file['bytes'] / 1e6:.2f} MB)")
    print(f"start     {local_time(facts['start_ns'])}, for {facts['seconds']:.1f} s")
    for jump in jumps:
        print(f"clock     {jump.text(facts['start_ns'])}")
    if "fingerprint" in facts["table"]:
        print(f"table     {facts['table']['fingerprint']}")
    if not facts["complete"]:
        print("state     incomplete: the recorder was killed or is still running")
    topics = [topic for topic in facts["topics"] if topic["count"]]
    rates = ["" if topic["rate"] is None else f"{topic['rate']:.1f}/s" for topic in topics]
    rows = [(one["topic"], one["type"] or "raw bytes", str(one["count"]), rate) for one, rate in zip(topics, rates)]
    for line in _columns([("topic", "type", "count", "rate"), *rows]):
        print(line)


def _columns(rows: Sequence[tuple[str, str, str, str]]) -> Iterator[str]:
    """Yield the lines of a table of two names and two numbers.

    On a narrow terminal, names are shortened, but never a number: a shortened number is another one.
    """
    topic, type, count, rate = (max(map(len, column)) for column in zip(*rows))
    if sys.stdout.isatty():
        room = max(shutil.get_terminal_size().columns - count - rate - 3 * len(_GAP), 2)
        topic = min(topic, max(room - type, room // 2))
        type = min(type, room - topic)
    for row in rows:
        names = f"{_shortened(row[0], topic):<{topic}}", f"{_shortened(row[1], type):<{type}}"
        yield _GAP.join((*names, f"{row[2]:>{count}}", f"{row[3]:>{rate}}"))


def _shortened(name: str, width: int) -> str:
    return name if len(name) <= width else f"{name[: width - 1]}…"
