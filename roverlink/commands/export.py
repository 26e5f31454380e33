"""``roverlink export``: a topic of a recording as a table."""

from __future__ import annotations

import argparse
from pathlib import Path

from roverlink.console import FINDINGS, OK, Subparsers, command
from roverlink.runtime import SetupError
from roverlink.runtime.atomic_files import replacing
from roverlink.runtime.recording import EXPORTS


def add(commands: Subparsers) -> None:
    """Declare the command."""
    parser = command(
        commands,
        "export",
        "write a topic of a recording as a table: a row a message, a column a field",
        "roverlink export run.mcap --topic imu_data --to csv",
    )
    parser.add_argument("recording", type=Path, help="any file of the recording")
    parser.add_argument("--topic", required=True, help="the topic")
    parser.add_argument("--to", choices=EXPORTS, default="csv", help="the format (default: %(default)s)")
    parser.add_argument("--out", type=Path, metavar="FILE", help="the file (default: run.imu_data.csv, and so on)")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Write the table; exit code 1 where the topic has no message."""
    from roverlink.runtime.recording.reader import Recording
    from roverlink.runtime.recording.tables import WRITERS, rows_of

    recording = Recording(arguments.recording)
    rows = rows_of(recording, arguments.topic)
    named = arguments.topic.strip("/").replace("/", ".")
    out = arguments.out or arguments.recording.with_suffix(f".{named}.{arguments.to}")
    try:
        with replacing(out) as part:
            written = WRITERS[arguments.to](rows, part)
    except OSError as error:
        raise SetupError(f"{out}: cannot be written: {error.strerror or error}") from error
    print(f"{written} messages of {arguments.topic} to {out}")
    return OK if written else FINDINGS
