"""Hash of a payload's wire schema. Two programs with equal hashes read the same bytes in the same way.

The hash is the first four bytes of SHA-256, as a big-endian number, over this text in UTF-8:

- The first line is the full name of the payload's message.
- Then comes each message that the payload contains at any depth, and the payload itself, sorted by full name: the line
  ``message NAME``, and a line for each field, sorted by number.
- Then comes each enum in the same way: the line ``enum NAME``, and the line ``NUMBER NAME`` for each value.
- The line of a field is ``NUMBER NAME TYPE``. TYPE is a scalar's name, or a message's or an enum's full name.
- Behind TYPE come, if they apply: ``optional``, ``required`` or ``repeated``; and ``in ONEOF``. A message field and a
  member of a oneof never have ``optional``.
- At the end of the line of a message or field come settings that change how it is decoded, sorted by name, with the
  value in JSON: ``default="7"``.
- The entries of a map are a message with two fields, as protoc makes it.
- Each line ends with a line feed.

Comments, files, the order in a file, and reserved numbers are left out.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping

from roverlink.generator.protos.schema import ProtoField, Schema


def row_hash(schema: Schema, payload: str) -> int:
    """Return the 32-bit hash of a payload's wire schema; ``payload`` is the full name of its message."""
    text = "".join(f"{line}\n" for line in _lines(schema, payload))
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:4], "big")


def _lines(schema: Schema, payload: str) -> Iterator[str]:
    messages, enums = schema.reachable(payload)
    yield payload
    for name in sorted(messages):
        message = schema.messages[name]
        yield " ".join(["message", name, *_settings(message.facets)])
        yield from map(_field_line, sorted(message.fields, key=lambda field: field.number))
    for name in sorted(enums):
        yield f"enum {name}"
        values = sorted((value.number, value.name) for value in schema.enums[name].values)
        yield from (f"{number} {value}" for number, value in values)


def _field_line(field: ProtoField) -> str:
    wire = field.on_the_wire()
    parts = [str(wire.number), wire.name, wire.type, wire.label, wire.oneof and f"in {wire.oneof}"]
    of_group = {"delimited": "true"} if field.type == "group" else {}
    return " ".join(filter(None, [*parts, *_settings({**field.facets, **of_group})]))


def _settings(facets: Mapping[str, str]) -> list[str]:
    return [f"{name}={json.dumps(value)}" for name, value in sorted(facets.items())]
