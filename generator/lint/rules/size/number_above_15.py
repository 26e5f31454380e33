"""A microcontroller sends fields with numbers above 15.

The number and the wire type of a field take one byte up to number 15, and two bytes from 16 on (encoding guide,
"Message Structure"). A board that sends a message many times a second over a slow link sends this byte every time.
Choose small numbers for a new message, because published numbers must not change later.

Bad::

    message Sample {
      float x = 16;
    }

Good::

    message Sample {
      float x = 1;
    }
"""

from __future__ import annotations

from collections.abc import Iterator

from roverlink.generator.diagnostics import Diagnostic, Rule, Severity
from roverlink.generator.lint.context import Context
from roverlink.generator.protos.schema import ProtoMessage

RULE = Rule("FIX104", "number-above-15", __doc__, Severity.HINT)
_LAST_SHORT = 15


def check(context: Context) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each message with a field number above 15 that a peer with `max_size` sends."""
    table, schema = context.table, context.schema
    limited = {peer.name for peer in table.peers if peer.max_size is not None}
    sent = [row.proto for row in table.rows if row.inbound and row.peer in limited]
    if schema is None or not sent:
        return
    for name in sorted(schema.reachable(*sent)[0]):
        yield from _check(schema.messages[name])


def _check(message: ProtoMessage) -> Iterator[Diagnostic]:
    long = sorted((field for field in message.fields if field.number > _LAST_SHORT), key=lambda field: field.number)
    if not long:
        return
    used = {field.number for field in message.fields}
    used |= {number for first, last in message.reserved for number in range(first, min(last, _LAST_SHORT) + 1)}
    free = [number for number in range(1, _LAST_SHORT + 1) if number not in used]
    named = [f"`{field.name} = {field.number}`" for field in long[:3]] + ["..."] * (len(long) > 3)
    text = f"field numbers above {_LAST_SHORT} take one more byte in each message: {', '.join(named)}"
    unused = (
        f"in a new message, use the free number {free[0]}"
        if free
        else "in a new message, give these numbers to the rarest fields"
    )
    help = f"{unused}; never change a published number"
    yield RULE.at(long[0].at("number"), text, help, type=message.full_name, number=long[0].number)
