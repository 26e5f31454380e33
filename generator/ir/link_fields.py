"""Link message: its fields, with their comments in the generated .proto file."""

from __future__ import annotations

from roverlink.generator.ir.model import WireField

LINK_MEMBER = "link"
"""Name of the link message's member in the envelope's oneof."""
LINK_MESSAGE = "roverlink.Link"
"""Full name of the link message."""
LINK_ROWS = 8
"""Largest number of rows whose hashes one link message tells, so that a microcontroller needs little memory."""
_FIELDS = (
    ("session", "uint32", "", "Random number that the sender chooses when it starts."),
    ("sequence", "uint32", "", "Number of this link message, from 1. It counts the link messages to this receiver."),
    ("sent", "uint32", "", "Datagrams that the sender sent to this receiver before this one."),
    (
        "received",
        "uint32",
        "",
        "Datagrams that the sender had received from this receiver before the link message that echo_us names.",
    ),
    (
        "time_us",
        "uint64",
        "",
        "Sender's clock at sending, in microseconds. It may start anywhere.",
    ),
    (
        "echo_us",
        "uint64",
        "",
        "time_us of the last link message that the sender received from this receiver; 0 if there is none.",
    ),
    ("echo_age_us", "uint32", "", "Time from the arrival of that message until now, in microseconds."),
    (
        "numbers",
        "uint32",
        "repeated",
        f"Numbers of payloads that the sender speaks, at most {LINK_ROWS}; the next link messages tell the others.",
    ),
    ("hashes", "fixed32", "repeated", "Hash of the wire schema of each payload in `numbers`."),
)
LINK_FIELDS = tuple(
    WireField(number, name, type, label, "", comment) for number, (name, type, label, comment) in enumerate(_FIELDS, 1)
)
"""Fields of the link message."""
_LARGEST = {"uint32": 5, "uint64": 10, "fixed32": 4}


def largest_link_size() -> int:
    """Return the largest size in bytes of an encoded link message."""
    # A tag has one byte, and so has the length of a repeated field.
    sizes = [(_LARGEST[field.type], LINK_ROWS if field.label else 0) for field in LINK_FIELDS]
    return sum(2 + rows * size if rows else 1 + size for size, rows in sizes)
