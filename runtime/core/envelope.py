"""The envelope on the wire: what trailing zeros mean, and which payload numbers are in it.

Boards differ in what they do with trailing zeros: some send the envelope as the protobuf library writes it, some strip
the zero bytes at its end, some pad it with zeros up to the size of their buffer. All three mean the same envelope.
Two facts of the encoding make restoring exact: a field never starts with a zero byte (field number 0 does not exist),
so zeros where a field would start are padding; and a field's last tag byte is never zero, so what was stripped always
belongs to the last field, whose own length says how much is missing.
"""

from __future__ import annotations

from roverlink.runtime.core.wire_format import DELIMITED, fields


def restore(datagram: bytes) -> bytes:
    """The envelope as it was before its trailing zeros were stripped, or before it was padded with zeros.

    Linear in the size of the datagram, and the identity for every valid envelope. What is no envelope at all is
    returned as far as it can be read; parsing it then fails.
    """
    end = 0
    for field in fields(datagram):
        end = field.end
    if end > len(datagram):
        # A length that no datagram can carry is not restored but left for the parser to refuse.
        return datagram + bytes(end - len(datagram)) if end <= _LARGEST_DATAGRAM else datagram
    return datagram if datagram[end:].strip(b"\0") else datagram[:end]


_LARGEST_DATAGRAM = 65_507  # of UDP over IPv4


def strip_trailing_zeros(datagram: bytes) -> bytes:
    """The shortest datagram that `restore` brings back to this one."""
    return datagram.rstrip(b"\0")


def payload_numbers(datagram: bytes) -> list[int]:
    """The numbers of the length-delimited fields of an envelope, known to this program or not."""
    return [field.number for field in fields(datagram) if field.wire_type == DELIMITED]
