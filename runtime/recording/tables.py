"""Export of a recorded topic as a CSV or Parquet file, for spreadsheets and notebooks: one line for each message."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import SetupError, nearest
from roverlink.runtime.recording.mcap_file import Channel
from roverlink.runtime.recording.message_definitions import message_type_from
from roverlink.runtime.recording.reader import Recording
from roverlink.runtime.text.values import message_to_values

Row = dict[str, Any]

_BATCH = 50_000  # rows of a Parquet row group, held in memory


def rows_of(recording: Recording, topic: str) -> Iterator[Row]:
    """Yield one line of the exported file for each message of a topic: a dict with the values by column.

    The columns ``time_ns`` (steady time) and ``wall_ns`` (the computer's clock) are nanoseconds since 1970; see
    `clocks`. Each field is a column; a field of a nested message is a column with a dotted name. Messages are parsed
    with the definition in the recording. Raises `SetupError` if the topic does not exist or is not a ROS 2 topic.
    """
    channel = _channel(recording, topic)
    message_type = message_type_from(channel.schema_name, channel.schema.decode())
    for message in recording.messages():
        if message.channel.topic == channel.topic:
            values = message_to_values(cdr.decode(message_type, message.data))
            yield {"time_ns": message.time, "wall_ns": message.wall, **_flat(values)}


def _channel(recording: Recording, topic: str) -> Channel:
    channels = {name: channel for name, (channel, _) in recording.channels().items() if channel.encoding == "cdr"}
    full = topic if topic.startswith("/") else f"/{topic}"
    if full not in channels:
        hint = nearest(full, channels) if channels else "it has no ROS 2 topics"
        raise SetupError(f"the recording has no topic {topic!r}; {hint}")
    return channels[full]


def _flat(values: Mapping[str, Any], prefix: str = "") -> Row:
    row: Row = {}
    for name, value in values.items():
        if isinstance(value, Mapping):
            row.update(_flat(value, f"{prefix}{name}."))
        else:
            row[prefix + name] = value
    return row


def write_csv(rows: Iterator[Row], path: Path) -> int:
    """Write the lines from `rows_of` to a CSV file; lists are written as JSON.

    Return the number of lines. Raises `OSError`.
    """
    with path.open("w", encoding="utf-8", newline="") as file:
        written = 0
        writer = csv.writer(file, lineterminator="\n")
        for row in rows:
            if not written:
                writer.writerow(row)
            writer.writerow([json.dumps(value) if isinstance(value, list) else value for value in row.values()])
            written += 1
    return written


def write_parquet(rows: Iterator[Row], path: Path) -> int:
    """Write the lines from `rows_of` to a Parquet file, and return their number.

    Raises `OSError`.
    """
    import pyarrow  # here: it is an optional package
    import pyarrow.parquet

    written, writer = 0, None
    try:
        # range first: zip would otherwise take a row from the iterator and drop it at the end of a batch.
        while batch := [row for _, row in zip(range(_BATCH), rows)]:
            table = pyarrow.Table.from_pylist(batch, schema=writer.schema if writer else None)
            writer = writer or pyarrow.parquet.ParquetWriter(path, table.schema)
            writer.write_table(table)
            written += len(batch)
    finally:
        if writer is not None:
            writer.close()
    return written


WRITERS: Mapping[str, Callable[[Iterator[Row], Path], int]] = {"csv": write_csv, "parquet": write_parquet}
