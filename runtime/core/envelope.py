"""Functions for the bytes of an envelope: they restore its trailing zeros, and read the numbers of its payloads.

The boards that send datagrams treat trailing zeros differently. Some send the envelope as the protobuf library writes
it. Some strip the zero bytes at its end. Some append zeros up to the size of their buffer. All three forms mean the
same envelope.

Two facts of the encoding (protobuf.dev, Encoding) make it possible to restore the envelope exactly:
- No field starts with a zero byte, because field number 0 does not exist. So a zero byte where a field would start is
  padding.
- The last byte of a tag is never zero. So stripped zeros belong to the value of the last field, whose length tells how
  many zeros are missing.
"""

from __future__ import annotations

from roverlink.datagram_size import LARGEST_DATAGRAM
from roverlink.runtime.core.wire_format import DELIMITED, fields


def restore(datagram: bytes) -> bytes:
    """Append the trailing zeros that were stripped from an envelope, or remove zeros that were appended to it.

    Takes time linear in the datagram's size. Returns every valid envelope unchanged. Bytes that are not an envelope are
    returned unchanged, or with zeros appended or removed; parsing them as an envelope then fails.
    """
    end = 0
    # Only lengths are followed, nothing is parsed: the schema of the payload plays no role.
    for field in fields(datagram):
        end = field.end
    # Zeros were stripped: the last field says how long it is, and everything behind the last byte that was sent is
    # zero.
    if end > len(datagram):
        # A corrupt length field must not make us allocate gigabytes: the parser refuses it.
        return datagram + bytes(end - len(datagram)) if end <= LARGEST_DATAGRAM else datagram
    # Only zeros may be padding. Anything else is not understood, and stays for the parser to refuse.
    return datagram if datagram[end:].strip(b"\0") else datagram[:end]


def strip_trailing_zeros(datagram: bytes) -> bytes:
    """Return a datagram without the zero bytes at its end; `restore` appends them again."""
    return datagram.rstrip(b"\0")


def payload_numbers(datagram: bytes) -> list[int]:
    """Return the numbers of the payloads in a serialized envelope, in the order of the bytes.

    A payload is a message, so every length-delimited field of the envelope counts. Numbers that the envelope's schema
    does not declare are included.
    """
    return [field.number for field in fields(datagram) if field.wire_type == DELIMITED]
