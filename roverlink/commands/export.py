"""``roverlink export``: write a topic of a recording to a file as a table."""

from __future__ import annotations

import argparse
from pathlib import Path

from roverlink.console import FINDINGS, OK, Subparsers, add_recording, command
from roverlink.runtime import SetupError
from roverlink.runtime.atomic_files import replacing
from roverlink.runtime.recording import EXPORTS


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = command(
        commands,
        "export",
        "write one topic of a recording to a table, with a row for each message and a column for each field",
        "roverlink export run.mcap --topic imu_data --to csv",
    )
    add_recording(parser)
    parser.add_argument("--topic", required=True, help="name of the ROS 2 topic")
    parser.add_argument("--to", choices=EXPORTS, default="csv", help="format of the table (default: %(default)s)")
    parser.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help="file for the table (default: the recording's name with the topic's name, such as run.imu_data.csv)",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Write the file. The exit code is 1 if the topic has no messages."""
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
        raise SetupError(f"{out}: cannot write the file: {error.strerror or error}") from error
    print(f"wrote {written} messages of {arguments.topic} to {out}")
    return OK if written else FINDINGS
