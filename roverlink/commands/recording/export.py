"""Write one topic of a recording to a table, with a row for each message and a column for each field.

Write one topic of a recording to a table for spreadsheets or notebooks: a CSV or Parquet file. It has a row
for each message, and a column for each field, such as accel_x; nested fields have dotted names. The columns
time_ns and wall_ns are nanoseconds since 1970: time_ns counts on steadily, and wall_ns is what the clock of
the computer showed. They differ after the clock was set during the recording; a note then says when.

`roverlink recording info` lists the topics. Exit code 1: the topic has no messages.

Example: roverlink recording export run.mcap --topic imu_data --to csv
"""

from __future__ import annotations

import argparse
from pathlib import Path

from roverlink.console import FINDINGS, OK, Subparsers, add_recording, documented_command, print_note
from roverlink.numerals import counted
from roverlink.runtime import SetupError
from roverlink.runtime.atomic_files import replacing
from roverlink.runtime.recording import EXPORTS


def add(commands: Subparsers) -> None:
    """Add the command and its options to the command line."""
    parser = documented_command(commands, __name__, __doc__)
    add_recording(parser)
    parser.add_argument("--topic", required=True, help="name of the recorded ROS 2 topic, such as imu_data")
    parser.add_argument("--to", choices=EXPORTS, default="csv", help="format of the table (default: %(default)s)")
    parser.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help="file for the table (default: the recording's name with the topic's name, such as run.imu_data.csv)",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Write the table of the topic's messages to a file. The exit code is 1 if the topic has no messages."""
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
    for jump in recording.jumps:
        print_note(f"the computer's clock {jump.text(recording.start)}; wall_ns follows it, time_ns counts on")
    print(f"wrote {counted(written, 'message')} of {arguments.topic} to {out}")
    return OK if written else FINDINGS
