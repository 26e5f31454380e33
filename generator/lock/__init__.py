"""The ledger, mapping.lock: every published number, and the wire schema at the last generate.

Rules:

- Each fact has one line, so a diff can be reviewed line by line.
- Facts are never removed: a number that no longer exists is marked as ``gone``.
- The last line is a checksum of the others. It shows that the file was edited or cut short.
- Two branches that both change the ledger always have a merge conflict, at least in the checksum. Reading accepts the
  lines of both sides, and the next generate writes them in order.
"""

from roverlink.generator.lock.ledger import NAME, Burned, Entry, Ledger, checksum
from roverlink.generator.lock.ledger_reader import read
from roverlink.generator.lock.ledger_text import render, schema_lines

__all__ = [
    "NAME",
    "Burned",
    "Entry",
    "Ledger",
    "checksum",
    "read",
    "render",
    "schema_lines",
]
