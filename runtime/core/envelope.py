"""The envelope on the wire: trailing zeros, and the payload numbers in it.

Boards treat trailing zeros differently: some send the envelope as the protobuf library writes it, some strip the zero
bytes at its end, some pad it with zeros up to the size of their buffer. All three mean the same envelope.

Two facts of the encoding (protobuf.dev, Encoding) make restoring exact:
- No field starts with a zero byte, because field number 0 does not exist. So zeros in the place of a field are padding.
- The last byte of a tag is never zero. So stripped zeros belong to the last field, and its length tells how many are
missing.
"""

from __future__ import annotations

from roverlink.runtime.core.wire_format import DELIMITED, fields


def restore(datagram: bytes) -> bytes:
    """Restore an envelope whose trailing zeros were stripped, or that was padded with zeros.

    Takes time linear in the datagram's size, and returns every valid envelope unchanged. Bytes that are not an envelope
    come back unchanged or extended; parsing them fails afterwards.
    """
    end = 0
    # Only lengths are followed, nothing is parsed: the schema of the payload plays no role.
    for field in fields(datagram):
        end = field.end
    # Zeros were stripped: the last field says how long it is, and everything behind the last byte that was sent is
    # zero.
    if end > len(datagram):
        # A corrupt length field must not make us allocate gigabytes: the parser refuses it.
        return datagram + bytes(end - len(datagram)) if end <= _LARGEST_DATAGRAM else datagram
    # Only zeros may be padding. Anything else is not understood, and stays for the parser to refuse.
    return datagram if datagram[end:].strip(b"\0") else datagram[:end]


_LARGEST_DATAGRAM = 65_507  # bytes of UDP payload over IPv4: 65,535 - 20 (IP header) - 8 (UDP header)


def strip_trailing_zeros(datagram: bytes) -> bytes:
    """Return the shortest datagram that `restore` turns back into this one."""
    return datagram.rstrip(b"\0")


def payload_numbers(datagram: bytes) -> list[int]:
    """Return the numbers of an envelope's length-delimited fields, including those unknown to this program."""
    return [field.number for field in fields(datagram) if field.wire_type == DELIMITED]
