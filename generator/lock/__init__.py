"""mapping.lock, the ledger: every number ever published, and the wire schema as of the last generate.

One line a fact, so that a diff can be reviewed line by line. Facts are only ever added: what is gone stays, and says
so. The last line is a checksum of all others, by which a file that was edited or cut short is noticed. Two branches
that both changed the ledger disagree at least there, so that merging them is always a conflict; reading takes the
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
