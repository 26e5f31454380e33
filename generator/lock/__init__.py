"""The ledger, mapping.lock: a record of every field number that was ever used, so that no number gets a new meaning.

It contains the numbers of the payloads. As of the last `roverlink generate`, it also contains the settings of their
rows (direction, types, QoS, deadman, limits, request) and the wire schema (fields and enum values with their numbers).
A number in it counts as published: boards may send it. Rules of the file:

- Each payload, setting, field and enum value has its own line, so a diff can be reviewed line by line.
- The line of a payload, field or value that no longer exists is not removed, but marked as ``gone``.
- The last line is a checksum of the others. It shows that the file was edited or cut short.
- A number with several meanings in git's history, whose past the user has accepted, is ``burned``. A folder of .proto
  files without a table has these lines in a ledger of its own, accepted-numbers.lock, beside the rules that the user
  has accepted there.
- Two branches that both change the ledger always have a merge conflict, at least in the checksum. Reading accepts the
  lines of both sides, and the next generate writes them in order.
"""

from roverlink.generator.ledger_names import ACCEPTED as ACCEPTED_NAME
from roverlink.generator.ledger_names import LEDGER as NAME
from roverlink.generator.lock.ledger import Burned, Entry, Ledger, PastUse, Settled, checksum
from roverlink.generator.lock.ledger_reader import read
from roverlink.generator.lock.ledger_text import render, render_accepted, schema_lines
from roverlink.generator.lock.row_settings import (
    DEADMAN,
    EXTRA_TOPIC,
    LIMITS,
    REQUESTS,
    RowSettings,
    Setting,
    settings_of_row,
    settings_of_rows,
    topics_of,
)

__all__ = [
    "ACCEPTED_NAME",
    "DEADMAN",
    "EXTRA_TOPIC",
    "LIMITS",
    "NAME",
    "REQUESTS",
    "Burned",
    "Entry",
    "Ledger",
    "PastUse",
    "RowSettings",
    "Setting",
    "Settled",
    "checksum",
    "read",
    "render",
    "render_accepted",
    "schema_lines",
    "settings_of_row",
    "settings_of_rows",
    "topics_of",
]
